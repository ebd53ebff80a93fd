"""The mean pose in other programs' files: `markers.trc`, `motion.bvh`."""

import numpy as np
from angles import mean_state
from ledger import known
from points import columns
from rotations import PARENTS, in_the_world
from scipy.spatial.transform import Rotation

# Link on which a marker lies.
LINKS = {
    **{f"{side}{name}": f"{side.lower()}_{link}" for side in "RL" for name, link in (("Knee", "thigh"), ("Ankle", "shin"), ("Elbow", "upper_arm"), ("Wrist", "forearm"))},
    **{f"{side}{name}": f"{side.lower()}_foot" for side in "RL" for name in ("BigToe", "SmallToe", "Heel")},
    **{f"{side}Hip": "pelvis" for side in "RL"},
    "MidHip": "pelvis",
    **{f"{side}Shoulder": "girdle" for side in "RL"},
    "Neck": "spine",
    **{name: "head" for name in ("Head", "Nose", "REye", "LEye", "REar", "LEar")},
}
# Marker from which the place on a link is taken; of pelvis and spine the origin of the pelvis.
ORIGINS = {
    "pelvis": "pelvis",
    "spine": "pelvis",
    "girdle": "Neck",
    "head": "Neck",
    **{f"{side}_{link}": f"{side.upper()}{name}" for side in "rl" for link, name in (("thigh", "Hip"), ("shin", "Knee"), ("foot", "Ankle"), ("upper_arm", "Shoulder"), ("forearm", "Elbow"))},
}
LENGTHS = {"Knee": "thigh", "Ankle": "shin", "Elbow": "upper_arm", "Wrist": "forearm"}


def markers(results):
    """Places of all markers in the world, frames × 3 each: the file has (y, z, x)."""
    table = results.tables["markers.trc"]
    names = [column.removesuffix(".X") for column in table if column.endswith(".X")]
    return {name: table[[f"{name}.Z", f"{name}.X", f"{name}.Y"]].to_numpy() for name in names}


@known("markers.trc", "Frame#", source="frames are counted from 1")
def trc_frames_are_counted(results):
    assert list(results.tables["markers.trc"]["Frame#"]) == list(range(1, results.frames + 1))


@known("markers.trc", "*.X", "*.Y", "*.Z", source="links are rigid, turned as `state.csv` says by SciPy's rotations, as long as `setup.toml` says, and near the means of `joints.csv`")
def markers_lie_on_rigid_links(results):
    placed = markers(results)
    states, names = mean_state(results)
    assert sorted(placed) == sorted(LINKS)
    placed["pelvis"] = states[:, [names.index(f"pelvis.t{axis}") for axis in "xyz"]]
    turned = in_the_world(names, states)
    for marker, link in LINKS.items():
        away = turned[link].inv().apply(placed[marker] - placed[ORIGINS[link]])
        assert np.ptp(away, axis=0).max() < 1e-6, marker
        length = LENGTHS.get(marker[1:])
        if length is not None:
            expected = results.setup["proportions"][length]
            assert np.allclose(np.linalg.norm(away, axis=-1), expected, atol=1e-6), marker
    means, sds = (columns(results, "joints.csv", "joint", what) for what in ("mean", "sd"))
    for k, marker in enumerate(results.draws["marker"]):
        assert (abs(placed[marker] - means[:, k]) < 0.8 * sds[:, k]).all(), marker


def bones(results):
    """Rotation and place of every joint and end of `motion.bvh`, in our world: the file has (x, z, −y)."""
    table = results.tables["motion.bvh"]
    ours = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    turned, placed = {}, {}
    for name, parent, offset in results.skeleton:
        if parent is None:
            placed[name] = table[[f"{name}.{axis}position" for axis in "XYZ"]].to_numpy()
        else:
            placed[name] = placed[parent] + turned[parent].apply(offset)
        if name.startswith("end "):
            continue
        own = Rotation.from_euler("ZYX", table[[f"{name}.{axis}rotation" for axis in "ZYX"]].to_numpy(), degrees=True)
        turned[name] = own if parent is None else turned[parent] * own
    world = Rotation.from_matrix(ours)
    return {name: world * turn for name, turn in turned.items()}, {name: place @ ours.T for name, place in placed.items()}


@known("motion.bvh", "time", source="the number of frames over the frame rate")
def bvh_frames_last_as_they_should(results):
    assert np.allclose(results.tables["motion.bvh"].time, np.arange(results.frames) / results.fps, atol=1e-5)


@known("motion.bvh", "*position", "*rotation", source="joints lie where `markers.trc` has them; bones turn as `state.csv` says, by SciPy's rotations")
def bones_are_at_the_markers(results):
    turned, placed = bones(results)
    at = markers(results)
    for side in "rl":
        for bone, marker in (("thigh", "Hip"), ("shin", "Knee"), ("foot", "Ankle"), ("upper_arm", "Shoulder"), ("forearm", "Elbow")):
            assert np.allclose(placed[f"{side}_{bone}"], at[f"{side.upper()}{marker}"], atol=1e-5), bone
        assert np.allclose(placed[f"end {side}_forearm"], at[f"{side.upper()}Wrist"], atol=1e-5)
    states, names = mean_state(results)
    links = in_the_world(names, states)
    for bone, turn in turned.items():
        link = next((link for link in PARENTS if bone in (link, f"spine_{link}", f"pelvis_{link}", f"girdle_{link}")), "pelvis")
        if bone.startswith(("spine_", "pelvis_", "girdle_")):
            link = bone.split("_")[0]
        rest = (links[link].inv() * turn).as_matrix()
        assert np.ptp(rest, axis=0).max() < 1e-5, bone
