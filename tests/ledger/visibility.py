"""Which angles keypoints show: `seen` of `angles.csv`, by the formula of `docs/reference/angles.md` with numeric derivatives of a body that is read off the markers."""

import numpy as np
from angles import mean_state
from ledger import known
from motion import LINKS, ORIGINS, markers
from rotations import in_the_world, joint_angles

ERROR_M, UNKNOWN, SEEN_DEG, STEP = 0.02, 1.0, 20.0, 1e-5


def pelvis(states, names):
    return states[:, [names.index(f"pelvis.t{axis}") for axis in "xyz"]]


def offsets(results, states, names):
    """Where each marker lies on its link, from the marker at the link's origin."""
    placed = markers(results) | {"pelvis": pelvis(states, names)}
    turned = in_the_world(names, states)
    away = {marker: turned[link].inv().apply(placed[marker] - placed[ORIGINS[link]]) for marker, link in LINKS.items()}
    return {marker: np.median(value, axis=0) for marker, value in away.items()}


def posed(states, names, on_link):
    """Places of the markers of some states, by name."""
    turned, placed = in_the_world(names, states), {"pelvis": pelvis(states, names)}

    def place(marker):
        if marker not in placed:
            placed[marker] = place(ORIGINS[LINKS[marker]]) + turned[LINKS[marker]].apply(on_link[marker])
        return placed[marker]

    return {marker: place(marker) for marker in on_link}


def derivatives(states, of):
    """∂ of / ∂ each degree of freedom, the last axis."""
    columns = []
    for dof in range(states.shape[1]):
        step = np.zeros(states.shape[1])
        step[dof] = STEP
        columns.append((of(states + step) - of(states - step)) / (2 * STEP))
    return np.stack(columns, -1)


def standard_deviations(results):
    """Of each angle by the keypoints of each frame alone, degrees, by name."""
    states, names = mean_state(results)
    on_link = offsets(results, states, names)
    keypoints = list(results.seen["keypoint"])
    jacobian = derivatives(states, lambda some: np.stack([posed(some, names, on_link)[name] for name in keypoints], 1))
    seen = np.isfinite(results.seen["pixel"][..., 0]).any(1)
    information = np.einsum("fp,fpai,fpaj->fij", seen, jacobian, jacobian) / ERROR_M**2 + np.eye(len(names)) / UNKNOWN**2
    covariance = np.linalg.inv(information)
    angle_names = list(joint_angles(names, states))
    turns = derivatives(states, lambda some: np.stack([joint_angles(names, some)[name] for name in angle_names], 1))
    return {name: np.sqrt(np.einsum("fi,fij,fj->f", turns[:, k], covariance, turns[:, k])) for k, name in enumerate(angle_names)}


@known("angles.csv", "seen", source="its formula, with numeric derivatives of a body read off `markers.trc`", runs=("filtered",))
def seen_is_what_keypoints_show(results):
    expected = standard_deviations(results)
    found, names = results.of("angles.csv", "seen", "name")
    for k, name in enumerate(names):
        # At the bound either is right.
        clear = abs(expected[name] - SEEN_DEG) > 0.01
        assert (found[clear, k] == (expected[name] <= SEEN_DEG)[clear]).all(), (name, expected[name])


@known("summary.json", "angles.unseen.*", source="shares of frames in which `seen` of `angles.csv` is 0, where there are any")
def summary_of_unseen_angles(results):
    found, names = results.of("angles.csv", "seen", "name")
    said = {column.removeprefix("angles.unseen."): value.iloc[0] for column, value in results.tables["summary.json"].items() if column.startswith("angles.unseen.")}
    shares = {name: 1 - found[:, k].mean() for k, name in enumerate(names)}
    for name, share in said.items():
        assert np.isclose(share, shares[name]), name
    assert set(said) == {name for name, share in shares.items() if share > 0}
