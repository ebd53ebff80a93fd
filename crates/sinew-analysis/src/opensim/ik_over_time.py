"""Inverse kinematics with a weight for each marker and frame: python ik_over_time.py

Reads scaled.osim, markers.trc and weights.csv beside this file and writes ik_over_time.mot and
ik_over_time_errors.csv (distance of each marker from the model's, m). Needs the package opensim, 4.3 or later.

OpenSim's tool has one weight for a run; its solver takes others before every frame. Like the tool it begins from the
model's default pose, here turned by quarters and sitting as well, of which the one counts that fits the first frame best.
"""

import csv
import pathlib

import opensim

ACCURACY = 1e-5
SITTING = {f"{joint}_{side}": 1.5708 for joint in ("hip_flexion", "knee_angle") for side in "rl"}
STARTS = [{**pose, "pelvis_rotation": turn} for pose in ({}, SITTING) for turn in (0.0, 1.5708, 3.1416, -1.5708)]


def table(path):
    """Names of the columns behind the first, and rows of numbers."""
    with open(path, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    return head[1:], [[float(cell) for cell in row] for row in rows]


# Flexion of the lumbar joint is not shown by markers; as in ik.xml it is held at its default.
HELD, HELD_WEIGHT = ("L5_S1_Flex_Ext", "lumbar_extension"), 0.1

# A solver keeps no hold of it: it must live as long.
COORDINATES = opensim.SimTKArrayCoordinateReference()


def hold(model):
    """Holds the coordinates of a model that markers do not show."""
    for name in HELD:
        if model.getCoordinateSet().contains(name):
            default = model.getCoordinateSet().get(name).getDefaultValue()
            held = opensim.CoordinateReference(name, opensim.Constant(default))
            held.setWeight(HELD_WEIGHT)
            COORDINATES.push_back(held)


def solver_of(model, reference):
    """A solver of a model's markers and the coordinates that are held."""
    solver = opensim.InverseKinematicsSolver(model, reference, COORDINATES, float("inf"))
    solver.setAccuracy(ACCURACY)
    return solver


def assembled(model, reference, names, start, time):
    """A state in the first frame from a start, its solver, and the sum of the squared distances of the markers."""
    state = model.initSystem()
    for name, value in start.items():
        if model.getCoordinateSet().contains(name):
            model.getCoordinateSet().get(name).setValue(state, value, False)
    state.setTime(time)
    solver = solver_of(model, reference)
    solver.assemble(state)
    return state, solver, sum(solver.computeCurrentSquaredMarkerError(name) for name in names)


def main(folder=pathlib.Path(__file__).resolve().parent):
    opensim.Logger.setLevelString("Error")
    model = opensim.Model(str(folder / "scaled.osim"))
    hold(model)
    names, rows = table(folder / "weights.csv")
    time, *weights = rows[0]
    markers = opensim.SetMarkerWeights()
    for name, weight in zip(names, weights):
        markers.cloneAndAppend(opensim.MarkerWeight(name, weight))
    reference = opensim.MarkersReference(str(folder / "markers.trc"), markers)
    errors = [assembled(model, reference, names, start, time)[2] for start in STARTS]
    state, solver, _ = assembled(model, reference, names, STARTS[errors.index(min(errors))], time)
    coordinates = list(model.getCoordinateSet())
    poses, distances = [], []
    for time, *weights in rows:
        state.setTime(time)
        for name, weight in zip(names, weights):
            solver.updateMarkerWeight(name, weight)
        solver.track(state)
        turned = [c.getMotionType() == opensim.Coordinate.Rotational for c in coordinates]
        value = [c.getValue(state) * (57.29577951308232 if turn else 1.0) for c, turn in zip(coordinates, turned)]
        poses.append([time, *value])
        distances.append([time, *(solver.computeCurrentMarkerError(name) for name in names)])
    head = ["Coordinates", "version=1", f"nRows={len(poses)}", f"nColumns={1 + len(coordinates)}", "inDegrees=yes"]
    lines = ["\t".join(["time", *(c.getName() for c in coordinates)])]
    lines += ["\t".join(f"{value:.8f}" for value in pose) for pose in poses]
    (folder / "ik_over_time.mot").write_text("\n".join([*head, "", "endheader", *lines, ""]), encoding="utf-8")
    with open(folder / "ik_over_time_errors.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([["time_s", *names], *distances])


if __name__ == "__main__":
    main()
