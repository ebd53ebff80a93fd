"""Turns of OpenSim's own model: `python opensim_turns.py Model_Pose2Sim_simple.osim opensim_turns.json`, with `pip install opensim` and the model of Pose2Sim's package (0.10.49).

For some poses of each joint, the values of its coordinates in degrees and the rotation of the child in the parent, row after row, in OpenSim's axes (x forward, y up, z to the right).
"""

import json
import sys

import numpy as np
import opensim

# Joints whose angles `sinew` names as OpenSim does.
JOINTS = ("ground_pelvis", "hip_r", "hip_l", "walker_knee_r", "walker_knee_l", "ankle_r", "ankle_l", "back", "acromial_r", "acromial_l", "elbow_r", "elbow_l")
POSES = 5
SMALLER_DEG, LARGER_DEG = 5.0, 40.0


def base(frame):
    return frame.findBaseFrame()


model = opensim.Model(sys.argv[1])
state = model.initSystem()
rng = np.random.default_rng(4)
turns = []
for joint in (model.getJointSet().get(name) for name in JOINTS):
    coordinates = [joint.get_coordinates(k) for k in range(joint.numCoordinates())]
    turned = [c for c in coordinates if c.getMotionType() == opensim.Coordinate.Rotational and not c.isDependent(state)]
    for _ in range(POSES):
        values = rng.choice([-1, 1], len(turned)) * rng.uniform(SMALLER_DEG, LARGER_DEG, len(turned))
        for coordinate, value in zip(turned, values):
            low, high = np.degrees([coordinate.getRangeMin(), coordinate.getRangeMax()])
            value = value if low <= value <= high else -value
            coordinate.setValue(state, np.radians(value), False)
        model.realizePosition(state)
        child, parent = base(joint.getChildFrame()), base(joint.getParentFrame())
        transform = child.findTransformBetween(state, parent)
        rotation = transform.R()
        turns.append(
            {
                "joint": joint.getName(),
                "coordinates": {c.getName(): round(float(np.degrees(c.getValue(state))), 9) for c in turned},
                "rotation": [[round(rotation.get(i, j), 9) + 0.0 for j in range(3)] for i in range(3)],
            }
        )
lines = ",\n".join(json.dumps(turn) for turn in turns)
with open(sys.argv[2], "w") as file:
    file.write(f'{{"opensim": {json.dumps(opensim.GetVersion())}, "model": {json.dumps(model.getName())}, "turns": [\n{lines}\n]}}\n')
