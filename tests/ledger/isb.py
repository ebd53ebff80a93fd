"""Angles by the definitions of the International Society of Biomechanics (`--angles isb`), by SciPy's rotations."""

import numpy as np
from angles import DEGREES, quantile, state_draws
from ledger import known
from rotations import in_the_world, joint_angles

# Mean length of unit vectors above which an angle has one branch in all draws: plane and rotation of a hanging arm are not defined.
ONE_BRANCH = 0.95


def isb_angles(dofs, angles):
    """All angles of `--angles isb` in degrees, by name, in the shape of `angles` (rad) without its last axis. Axes of links: right, forward, up."""
    shape = angles.shape[:-1]
    turned = in_the_world(dofs, angles)

    def euler(distal, proximal, order):
        own = turned[distal] if proximal is None else turned[proximal].inv() * turned[distal]
        return np.moveaxis(own.as_euler(order, degrees=True).reshape(*shape, 3), -1, 0)

    named = {name: value for name, value in joint_angles(dofs, angles).items() if name.startswith(("hip_", "knee_", "ankle_", "elbow_")) or name == "girdle_rz"}
    rotation, obliquity, backward = euler("pelvis", None, "ZYX")
    named |= {"pelvic_tilt": -backward, "pelvic_obliquity": obliquity, "pelvic_rotation": rotation}
    backward, bending, rotation = euler("girdle", "pelvis", "XYZ")
    named |= {"trunk_bending": bending, "trunk_rotation": rotation}
    backward, bending, rotation = euler("head", "girdle", "XYZ")
    named |= {"neck_flexion": -backward, "neck_bending": bending, "neck_rotation": rotation}
    for side in "rl":
        # About up, forward, and the arm itself; an arm at the right is raised by a negative turn about the forward axis.
        plane, raised, own = euler(f"{side}_upper_arm", "girdle", "ZYZ")
        plane, own = (plane + 180, own + 180) if side == "r" else (-plane, -own)
        named |= {f"shoulder_plane_{side}": plane, f"shoulder_elevation_{side}": raised, f"shoulder_rotation_{side}": own}
        named[f"ankle_inversion_{side}"] = np.degrees(angles[..., dofs.index(f"{side}_foot.ry")]) * (1 if side == "r" else -1)
    return named


@known("angles.csv", "name", "mean_deg", "q05_deg", "q95_deg", source="with `--angles isb`: the draws of `posterior.zarr`, by the definitions of Baker and Wu with SciPy's rotations", runs=("isb",))
def isb_angles_follow_from_draws(results):
    draws, names = state_draws(results)
    expected = isb_angles(names, draws)
    table = results.tables["angles.csv"]
    found = list(table.name[: len(table) // results.frames])
    assert list(table.name) == found * results.frames and sorted(found) == sorted(expected)
    series = np.stack([expected[name] for name in found], -1)
    vectors = np.exp(1j * np.radians(series)).mean(0)
    is_one = abs(vectors) > ONE_BRANCH
    assert is_one.mean() > 0.8
    middle = np.degrees(np.angle(vectors))
    series = middle + (series - middle + 180) % 360 - 180
    # An angle may be written a turn away, with its interval.
    turns = 360 * np.round((results.of("angles.csv", "mean_deg", "name")[0] - series.mean(0)) / 360)
    for what, value in (("mean", series.mean(0)), ("q05", quantile(series, 0.05)), ("q95", quantile(series, 0.95))):
        away = abs(results.of("angles.csv", f"{what}_deg", "name")[0] - value - turns)
        assert (away < DEGREES)[is_one].all(), (what, found[int(np.argmax((away * is_one).max(0)))], (away * is_one).max())
