"""Names, axes, order and signs of angles against OpenSim's own: turns of joints that OpenSim 4.6 computed for values of their coordinates (`opensim_turns.py`).

`angles_follow_from_draws` holds the program to the same definitions.
"""

import json
from pathlib import Path

import numpy as np
import pytest
from rotations import BALLS, HINGES, joint_angles
from scipy.spatial.transform import Rotation

FOUND = json.loads((Path(__file__).parent / "opensim_turns.json").read_text())
# OpenSim's x forward, y up and z right, in the order right, forward, up.
AXES = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
LINKS = {"ground_pelvis": "pelvis", "back": "spine"}
LINKS |= {f"{joint}_{side}": f"{side}_{link}" for side in "rl" for joint, link in (("hip", "thigh"), ("acromial", "upper_arm"), ("walker_knee", "shin"), ("ankle", "foot"), ("elbow", "forearm"))}
# Of the model's lumbar joint.
NAMES = {"L5_S1_Lat_Bending": "lumbar_bending", "L5_S1_axial_rotation": "lumbar_rotation"}
# Axes of OpenSim's knees, ankles and elbows are oblique; a straight hinge reads so much less or more of a turn of 40°.
OBLIQUE_DEG = 1.0


def angles_of(turn):
    """All angles where one link is turned as OpenSim has it, and the others are not; each link by turns about its up, forward and right axis."""
    dofs = [f"{link}.{axis}" for link in (*LINKS.values(), "head", "girdle") for axis in ("rz", "ry", "rx")]
    values = np.zeros(len(dofs))
    own = Rotation.from_matrix(AXES @ np.array(turn["rotation"]) @ AXES.T).as_euler("ZYX")
    first = dofs.index(f"{LINKS[turn['joint']]}.rz")
    values[first : first + 3] = own
    return joint_angles(dofs, values)


@pytest.mark.parametrize("turn", FOUND["turns"], ids=lambda turn: turn["joint"])
def test_an_angle_is_the_coordinate_of_opensim(turn):
    read = angles_of(turn)
    looked_at = 0
    for coordinate, value in turn["coordinates"].items():
        name = NAMES.get(coordinate, coordinate)
        if name == "L5_S1_Flex_Ext":
            # Of the body `h32` the lumbar spine does not bend forward.
            continue
        is_ball = any(name in names for names, _ in BALLS.values())
        assert abs(read[name] - value) < (1e-5 if is_ball else OBLIQUE_DEG), (name, read[name], value)
        looked_at += 1
    assert looked_at > 0


def test_all_joints_of_the_definitions_are_looked_at():
    coordinates = {NAMES.get(name, name) for turn in FOUND["turns"] for name in turn["coordinates"]}
    named = {name for names, _ in BALLS.values() for name in names if name} | {name.format(side) for name, _ in HINGES.values() for side in "rl"}
    assert named <= coordinates, named - coordinates
    assert FOUND["opensim"].startswith("4.6")
