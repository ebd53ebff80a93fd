"""OpenSim on what `sinew export opensim` writes, beside Pose2Sim's own settings and markers.

    python opensim_export.py SINEW RESULT OUT [THEIRS]     # in an environment of opensim_requirements.txt

SINEW is the program, RESULT a result folder, OUT a folder to work in, THEIRS Pose2Sim's markers of the same recording
(.trc). Pose2Sim's model `Model_Pose2Sim_simple.osim` is scaled and fitted

- with the export: its markers, places and weights, by OpenSim's tools, and by its script with weights over time;
- with our markers and Pose2Sim's places and weights (`opensim_ik.py`, set `Body25b`);
- with Pose2Sim's markers, places and weights.

Printed are distances between a model's markers and the file's, mm: root mean square over markers and frames, the largest
of all, and the largest of a marker's root mean squares, with its name. Where RESULT has the truth (`truth.trc`, of the
demo), coordinates are held against the angles that it has by definition: mean and root mean square difference. Inverse kinematics of the tools starts from the
model's default pose turned to the person, as `ik_over_time.py` and `opensim_ik.py` do. It fails where a tool does, where
a marker of the file is not fitted, or where a name of the export is none of the model.
"""

import csv
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import numpy as np
import opensim
from opensim_ik import angles

opensim.Logger.setLevelString("Error")

SETUP = Path(sysconfig.get_paths()["purelib"]) / "Pose2Sim/OpenSim_Setup"
MODEL = SETUP / "Model_Pose2Sim_simple.osim"
LENGTHS = {"pelvis_tx", "pelvis_ty", "pelvis_tz"}


def read_trc(path):
    lines = path.read_text().splitlines()
    names = [name for name in lines[3].split("\t")[2:] if name.strip()]
    rows = [[float(x or "nan") for x in line.split("\t")[: 2 + 3 * len(names)]] for line in lines[5:] if line.strip()]
    return names, np.array(rows)[:, 2:].reshape(len(rows), len(names), 3)


def read_mot(path):
    lines = path.read_text().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("time"))
    names = lines[start].split()
    return names, np.array([[float(x) for x in line.split()] for line in lines[start + 1 :] if line.strip()])


def distances(model_file, motion, trc):
    """Names, and distances of a model's markers from a file's in the poses of a motion (frames x markers), mm."""
    model = opensim.Model(str(model_file))
    state = model.initSystem()
    columns, table = read_mot(motion)
    names, places = read_trc(trc)
    kept = [(k, name) for k, name in enumerate(names) if model.getMarkerSet().contains(name)]
    coordinates = [(c, columns.index(c.getName())) for c in model.getCoordinateSet() if c.getName() in columns]
    out = []
    for row, measured in zip(table, places):
        for coordinate, column in coordinates:
            factor = 1 if coordinate.getName() in LENGTHS else np.pi / 180
            coordinate.setValue(state, float(row[column] * factor), False)
        model.assemble(state)
        model.realizePosition(state)
        at = lambda name: model.getMarkerSet().get(name).getLocationInGround(state).to_numpy()
        out.append([1000 * np.linalg.norm(at(name) - measured[k]) for k, name in kept])
    return [name for _, name in kept], np.array(out)


def show(what, names, far):
    each = np.sqrt((far**2).mean(0))
    worst = int(each.argmax())
    print(f"{what}: {len(names)} markers, {len(far)} frames: rms {np.sqrt((far**2).mean()):.1f} mm, largest {far.max():.1f},",
          f"worst {names[worst]} {each[worst]:.1f}")
    return dict(zip(names, each))


def turned(folder):
    """The scaled model's default pose as `ik_over_time.py` found it to fit: its tool begins from there."""
    columns, table = read_mot(folder / "ik_over_time.mot")
    model = opensim.Model(str(folder / "scaled.osim"))
    for coordinate in model.getCoordinateSet():
        factor = 1 if coordinate.getName() in LENGTHS else np.pi / 180
        if not coordinate.get_locked():
            coordinate.setDefaultValue(float(table[0, columns.index(coordinate.getName())] * factor))
    model.printToXML(str(folder / "scaled.osim"))


def exported(sinew, result, out):
    command = [sinew, "export", "opensim", str(result), "--model", str(MODEL), "-o", str(out), "--force"]
    subprocess.run(command, check=True, capture_output=True)
    assert opensim.MarkerSet(str(out / "marker_set.xml")).getSize() > 0
    opensim.ScaleTool(str(out / "scale.xml")).run()
    assert (out / "scaled.osim").exists(), "scaling wrote no model"
    subprocess.run([sys.executable, "ik_over_time.py"], cwd=out, check=True)
    turned(out)
    os.chdir(out)  # the tool looks for the model in the working folder
    assert opensim.InverseKinematicsTool(str(out / "ik.xml")).run(), "inverse kinematics failed"


def differences(folder):
    """Root mean square difference of the coordinates by constant and by changing weights, degrees."""
    (names, one), (_, other) = (read_mot(folder / name) for name in ("ik.mot", "ik_over_time.mot"))
    count = min(len(one), len(other))
    own = [k for k, name in enumerate(names) if name != "time" and name not in LENGTHS]
    rms = np.sqrt(((one[:count, own] - other[:count, own]) ** 2).mean(0))
    worst = int(rms.argmax())
    print(f"weights over time turn a joint by {np.median(rms):.2f} degrees (median), {names[own[worst]]} by {rms[worst]:.2f}")


def against(truth, motion):
    """Coordinates of a motion less the angles of true points by definition, degrees."""
    markers, points = read_trc(truth)
    true = angles({name: points[:, k] for k, name in enumerate(markers)})
    names, table = read_mot(motion)
    for name in (name for name in names if name in true):
        apart = (table[:, names.index(name)] - true[name][: len(table)] + 180) % 360 - 180
        print(f"{name} {apart.mean():+.1f}, rms {np.sqrt((apart**2).mean()):.1f}")


def main():
    script = Path(__file__).resolve().with_name("opensim_ik.py")
    sinew, result, out = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
    theirs = Path(sys.argv[4]).resolve() if len(sys.argv) > 4 else None
    opensim.ModelVisualizer.addDirToGeometrySearchPaths(str(SETUP / "Geometry"))
    ours = out / "export"
    exported(sinew, result, ours)
    trc = ours / "markers.trc"
    weights = next(csv.reader(open(ours / "weights.csv")))[1:]
    names, far = distances(ours / "scaled.osim", ours / "ik.mot", trc)
    assert sorted(names) == sorted(weights), "every marker of the export is in the model"
    show("export, one weight a marker", names, far)
    show("export, weights over time", *distances(ours / "scaled.osim", ours / "ik_over_time.mot", trc))
    differences(ours)
    if (result / "truth.trc").exists():
        against(result / "truth.trc", ours / "ik.mot")
    for what, markers in [("our markers, Pose2Sim's settings", trc), ("Pose2Sim's markers and settings", theirs)]:
        if markers is None:
            continue
        folder = out / what.split(",")[0].replace(" ", "_").replace("'", "")
        subprocess.run([sys.executable, str(script), "Body25b", str(markers), str(folder)], check=True, capture_output=True)
        show(what, *distances(folder / "scaled.osim", folder / "ik.mot", markers))


main()
