"""OpenSim's inverse kinematics on a table of markers, and what angles the markers say by definition.

    python opensim_ik.py SET MARKERS OUT [--model FILE]      # in an environment of opensim_requirements.txt

SET is a set of markers in the folder `Pose2Sim/OpenSim_Setup` of the wheel `pose2sim` (`Body25b`, `BlazePose`), MARKERS
a file .trc. The model is scaled by the set's own measurements, all frames of MARKERS together, then OUT gets

- `ik.mot`: inverse kinematics with the set's own weights;
- `markers.mot`: angles of MARKERS by the definitions of docs/reference/formats.md;
- `model_markers.mot`: the same of the model's markers in the poses of `ik.mot`;
- `rest_ik.mot`, `rest.mot`, `rest_joints.mot`: coordinates of a pose at rest, its angles by the definitions from the
  model's markers, and the same from the centres of its joints where points stand for joints. All coordinates are 0, but
  elbows and knees, so that they show their axes, the lift of the arms, on which their rotation depends, and the turn of
  the pelvis: they have their means over `ik.mot`;
- `fit.csv`: root mean square distance of each marker from the model's, and where the model's marker is from the centre
  of its joint with all coordinates at 0, mm.

The definitions are worked out here from points alone and share no code with `sinew`.
"""

import argparse
import csv
import os
import re
import shutil
import sysconfig
from pathlib import Path

import numpy as np
import opensim

opensim.Logger.setLevelString("Warn")

# Points that the definitions need; sets without some get the places of Body25b.
POINTS = [
    "LShoulder", "RShoulder", "LElbow", "RElbow", "LWrist", "RWrist", "LHip", "RHip", "LKnee", "RKnee", "LAnkle",
    "RAnkle", "LBigToe", "RBigToe", "LSmallToe", "RSmallToe", "LHeel", "RHeel", "Neck",
]  # fmt: skip


def read_trc(path):
    """Names, times (s) and points (frames x markers x 3, m), axes of the file."""
    lines = path.read_text().splitlines()
    names = [name for name in lines[3].split("\t")[2:] if name.strip()]
    rows = [[float(x or "nan") for x in line.rstrip("\n").split("\t")] for line in lines[5:] if line.strip()]
    table = np.array([row[: 2 + 3 * len(names)] for row in rows])
    assert lines[2].split("\t")[4] == "m", "markers in metres"
    return names, table[:, 1], table[:, 2:].reshape(len(table), len(names), 3)


def write_mot(path, times, columns):
    """Columns by name, degrees."""
    head = ["Coordinates", "version=1", f"nRows={len(times)}", f"nColumns={1 + len(columns)}", "inDegrees=yes", ""]
    rows = np.column_stack([times, *columns.values()])
    table = ["\t".join(["time", *columns]), *("\t".join(f"{x:.9f}" for x in row) for row in rows)]
    path.write_text("\n".join([*head, "endheader", *table, ""]))


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def axes(right, up):
    """Right, forward and up axis as columns."""
    return np.stack([right, np.cross(up, right), up], axis=-1)


def ball(base, link):
    """Turns about the right, the forward and the up axis, in this order, radians."""
    m = np.swapaxes(base, -1, -2) @ link
    flexion = np.arctan2(-m[..., 1, 2], m[..., 2, 2])
    adduction = np.arctan2(m[..., 0, 2], np.hypot(m[..., 0, 0], m[..., 0, 1]))
    return flexion, adduction, np.arctan2(-m[..., 0, 1], m[..., 0, 0])


def angles(points):
    """Angles by definition, degrees, of points by name (frames x 3) in the axes of .trc: X forward, Y up, Z right."""
    p = {name: at[..., [2, 0, 1]] for name, at in points.items()}  # right, forward, up
    along = lambda a, b: unit(p[b] - p[a])
    out = {}

    def put(names, values, signs=(1, 1, 1)):
        for name, value, sign in zip(names, values, signs):
            out[name] = sign * np.degrees(np.unwrap(value))

    right = along("LHip", "RHip")
    trunk = p["Neck"] - (p["LHip"] + p["RHip"]) / 2
    pelvis = axes(right, np.cross(right, unit(np.cross(trunk, right))))
    put(["pelvis_tilt", "pelvis_list", "pelvis_rotation"], ball(np.eye(3), pelvis))
    # The markers' shoulder girdle: its turn from the pelvis is lumbar and girdle together.
    across = along("LShoulder", "RShoulder")
    neck = p["Neck"] - (p["LShoulder"] + p["RShoulder"]) / 2
    girdle = axes(across, unit(neck - (neck * across).sum(-1, keepdims=True) * across))
    put(["lumbar_extension", "lumbar_bending", "lumbar_rotation"], ball(pelvis, girdle))
    for side, suffix, sign in [("R", "_r", 1), ("L", "_l", -1)]:
        mirrored = (1, sign, sign)
        part = lambda a, b: along(side + a, side + b)
        upper, lower = part("Shoulder", "Elbow"), part("Elbow", "Wrist")
        arm = axes(unit(np.cross(upper, lower)), -upper)
        put([f"arm_{k}{suffix}" for k in ("flex", "add", "rot")], ball(girdle, arm), mirrored)
        thigh, shin = part("Hip", "Knee"), part("Knee", "Ankle")
        hinge = unit(np.cross(shin, thigh))
        names = [f"hip_{k}{suffix}" for k in ("flexion", "adduction", "rotation")]
        put(names, ball(pelvis, axes(hinge, -thigh)), mirrored)
        between = lambda a, b: np.arccos(np.clip((a * b).sum(-1), -1, 1))
        sole = sign * unit(np.cross(p[side + "SmallToe"] - p[side + "Heel"], p[side + "BigToe"] - p[side + "Heel"]))
        shank = axes(hinge, -shin)
        ankle = np.arctan2(-(shank[..., 1] * sole).sum(-1), (shank[..., 2] * sole).sum(-1))
        names = [f"{k}{suffix}" for k in ("elbow_flex", "knee_angle", "ankle_angle")]
        put(names, (between(upper, lower), between(thigh, shin), ankle))
    return out


def with_markers(setup, chosen, model_file):
    """The unscaled model with the markers of a set, and the points of the definitions that it lacks."""
    model = opensim.Model(str(setup / model_file))
    markers = opensim.MarkerSet(str(setup / f"Markers_{chosen}.xml"))
    for marker in opensim.MarkerSet(str(setup / "Markers_Body25b.xml")):
        if marker.getName() in POINTS and not markers.contains(marker.getName()):
            markers.cloneAndAppend(marker)
    model.set_MarkerSet(markers)
    model.finalizeConnections()
    return model


def setup_file(setup, kind, chosen):
    """The text of a setup file; names of sets differ in case from file to file."""
    wanted = f"{kind}_setup_pose2sim_{chosen}.xml".lower()
    return next(path for path in setup.glob("*.xml") if path.name.lower() == wanted).read_text()


def replaced(text, **values):
    for name, value in values.items():
        text, count = re.subn(rf"<{name}>[^<]*</{name}>", f"<{name}>{value}</{name}>", text)
        assert count > 0, name
    return text


def scaled(setup, chosen, model, trc, times, out):
    """The model scaled by the distances of the markers, averaged over the frames; its markers stay on their links."""
    model.printToXML(str(out / "unscaled.osim"))
    shutil.copyfile(trc, out / "markers.trc")
    text = setup_file(setup, "Scaling", chosen)
    text = replaced(
        text,
        model_file="unscaled.osim",
        marker_set_file="Unassigned",
        scaling_order="measurements",
        marker_file="markers.trc",
        time_range=f"{times[0]} {times[-1]}",
        output_model_file="scaled.osim",
    )
    placer = text.index("<MarkerPlacer>")
    text = text[:placer] + re.sub("<apply>true</apply>", "<apply>false</apply>", text[placer:], count=1)
    (out / "scaling.xml").write_text(text)
    (out / "scaled.osim").unlink(missing_ok=True)
    opensim.ScaleTool(str(out / "scaling.xml")).run()  # it says False where markers are not moved, too
    return opensim.Model(str(out / "scaled.osim"))


# Poses from which inverse kinematics is tried, degrees: it finds the nearest minimum and not the best.
STANDING, SITTING = {}, {f"{joint}_{side}": 90 for joint in ("hip_flexion", "knee_angle") for side in "rl"}
STARTS = [{**posture, "pelvis_rotation": turn} for posture in (STANDING, SITTING) for turn in (0, 90, 180, -90)]


def started(model, start, path):
    """Writes the model with other default coordinates."""
    for coordinate in model.getCoordinateSet():
        value = start.get(coordinate.getName())
        if value is not None:
            coordinate.setDefaultValue(np.radians(value))
    model.printToXML(str(path))


def error_mm(path):
    """Root mean square distance of the markers in the first frame, as OpenSim writes it."""
    return 1000 * float(path.read_text().splitlines()[-1].split()[2])


def inverse_kinematics(setup, chosen, times, out):
    """Inverse kinematics from the start that fits the first frame best."""
    text = setup_file(setup, "IK", chosen)

    def run(start, last):
        started(opensim.Model(str(out / "scaled.osim")), start, out / "started.osim")
        setting = replaced(
            text,
            model_file="started.osim",
            time_range=f"{times[0]} {last}",
            output_motion_file="ik.mot",
            marker_file="markers.trc",
        )
        (out / "ik.xml").write_text(setting)
        assert opensim.InverseKinematicsTool(str(out / "ik.xml")).run(), "inverse kinematics failed"
        return error_mm(out / "_ik_marker_errors.sto")

    errors = [run(start, times[0]) for start in STARTS]
    print("from", len(STARTS), "starts the markers of the first frame are off by, mm:", np.round(errors, 1))
    run(STARTS[int(np.argmin(errors))], times[-1])


# Points that joints have, and the bodies whose origin is there.
JOINTS = {"Shoulder": "humerus", "Elbow": "ulna", "Wrist": "hand", "Hip": "femur", "Knee": "tibia", "Ankle": "talus"}


def marker_places(model, poses, joints=False):
    """Places of the model's markers by name (frames x 3), of poses by coordinate (frames), radians and metres.

    With `joints`, points of joints are where the model's joints are and not where its markers are.
    """
    state = model.initSystem()
    coordinates = [model.getCoordinateSet().get(name) for name in poses]
    markers = list(model.getMarkerSet())
    out = {marker.getName(): [] for marker in markers}
    for values in zip(*poses.values()):
        for coordinate, value in zip(coordinates, values):
            coordinate.setValue(state, float(value), False)
        model.assemble(state)
        model.realizePosition(state)
        for marker in markers:
            out[marker.getName()].append(marker.getLocationInGround(state).to_numpy().copy())
        for name, body in JOINTS.items() if joints else ():
            for side in "RL":
                place = model.getBodySet().get(f"{body}_{side.lower()}").getPositionInGround(state)
                out[side + name][-1] = place.to_numpy().copy()
    return {name: np.array(places) for name, places in out.items()}


def read_poses(model, path):
    """Coordinates of a motion file by name, radians and metres."""
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("time"))
    names = lines[start].split()
    table = np.array([[float(x) for x in line.split()] for line in lines[start + 1 :] if line.strip()])
    lengths = {"pelvis_tx", "pelvis_ty", "pelvis_tz"}
    known = [c.getName() for c in model.getCoordinateSet()]
    column = lambda name: table[:, names.index(name)] * (1 if name in lengths else np.pi / 180)
    return {name: column(name) for name in known}


def at_rest(poses):
    """The pose at rest that belongs to a motion, one frame, radians and metres."""
    rest = {name: np.zeros(1) for name in poses}
    sided = ("knee_angle", "elbow_flex", "arm_flex", "arm_add")
    kept = ["pelvis_rotation", *(f"{name}_{side}" for name in sided for side in "rl")]
    return rest | {name: np.full(1, poses[name].mean()) for name in kept}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("chosen")
    parser.add_argument("markers", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--model", default="Model_Pose2Sim_simple.osim")
    args = parser.parse_args()
    setup = Path(sysconfig.get_paths()["purelib"]) / "Pose2Sim/OpenSim_Setup"
    trc, out = args.markers.resolve(), args.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    os.chdir(out)  # some paths of OpenSim's setup files are relative to the file, others to the working folder
    opensim.ModelVisualizer.addDirToGeometrySearchPaths(str(setup / "Geometry"))
    names, times, places = read_trc(trc)
    model = scaled(setup, args.chosen, with_markers(setup, args.chosen, args.model), trc, times, out)
    inverse_kinematics(setup, args.chosen, times, out)
    measured = {name: places[:, i] for i, name in enumerate(names)}
    poses = read_poses(model, out / "ik.mot")
    modelled = marker_places(model, poses)
    rest = at_rest(poses)
    if all(name in measured for name in POINTS):
        write_mot(out / "markers.mot", times, angles(measured))
    write_mot(out / "model_markers.mot", times, angles(modelled))
    write_mot(out / "rest.mot", [0.0], angles(marker_places(model, rest)))
    write_mot(out / "rest_joints.mot", [0.0], angles(marker_places(model, rest, joints=True)))
    write_mot(out / "rest_ik.mot", [0.0], {name: np.degrees(values) for name, values in rest.items()})
    zero = {name: np.zeros(1) for name in poses}
    at_markers, at_joints = marker_places(model, zero), marker_places(model, zero, joints=True)
    with open(out / "fit.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["marker", "rms_mm", "forward_mm", "up_mm", "right_mm"])
        for name in [marker for marker in names if marker in modelled]:
            apart = np.linalg.norm(modelled[name] - measured[name], axis=-1)
            offset = 1000 * (at_markers[name] - at_joints[name])[0]
            has_joint = name[1:] in JOINTS
            rms = 1000 * np.sqrt(np.nanmean(apart**2))
            rows.writerow([name, f"{rms:.2f}", *(f"{x:.2f}" if has_joint else "" for x in offset)])


if __name__ == "__main__":
    main()
