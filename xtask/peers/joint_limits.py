"""What soft limits of joints change: coverage and error of hinge angles, distances of joints, on demos.

    python joint_limits.py SINEW OUT [SEEDS]      # numpy; prints a table in Markdown

Each demo is tracked with and without `--joint-limits on`, by four cameras and by the first alone. True angles are those
that the demo's true points have, by the definitions of opensim_ik.py. Errors are root mean squares over the frames.
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

CAMERAS = {"four": "C1,C2,C3,C4", "one": "C1"}
LIMBS = ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")
FEET = ("BigToe", "SmallToe", "Heel")
NAMES = {"shin.rx": "knee", "forearm.rx": "elbow", "foot.rx": "ankle", "foot.ry": "foot, sideways"}


def points(path):
    """Points by name (frames x 3): right, forward, up."""
    lines = path.read_text().splitlines()
    names = [name for name in lines[3].split("\t")[2:] if name.strip()]
    width = 2 + 3 * len(names)
    table = np.array([[float(x) for x in line.split("\t")[:width]] for line in lines[5:] if line.strip()])
    return {name: table[:, 2 + 3 * i : 5 + 3 * i][:, [2, 0, 1]] for i, name in enumerate(names)}


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def angles(p):
    """Hinge angles by coordinate, degrees."""
    out = {}
    for side, link, sign in (("R", "r_", 1), ("L", "l_", -1)):
        along = lambda a, b: unit(p[side + b] - p[side + a])
        between = lambda a, b: np.degrees(np.arccos(np.clip((a * b).sum(-1), -1, 1)))
        thigh, shin = along("Hip", "Knee"), along("Knee", "Ankle")
        out[link + "shin.rx"] = -between(thigh, shin)
        out[link + "forearm.rx"] = between(along("Shoulder", "Elbow"), along("Elbow", "Wrist"))
        hinge = unit(np.cross(shin, thigh))
        sole = sign * unit(np.cross(p[side + "SmallToe"] - p[side + "Heel"], p[side + "BigToe"] - p[side + "Heel"]))
        x, y, z = ((axis * sole).sum(-1) for axis in (hinge, np.cross(-shin, hinge), -shin))
        out[link + "foot.rx"] = np.degrees(np.arctan2(-y, z))
        out[link + "foot.ry"] = np.degrees(np.arcsin(x))
    return out


def intervals(path):
    """Mean, 5 % and 95 % quantile of each coordinate (frames x 3), degrees."""
    out = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            out.setdefault(row["name"], []).append([float(row[k]) for k in ("mean_deg", "q05_deg", "q95_deg")])
    return {name: np.array(rows) for name, rows in out.items()}


def around(x):
    return (x + 180) % 360 - 180


def run(arguments):
    """A run whose results are written; failed diagnostics are none of our business here."""
    done = subprocess.run(arguments, capture_output=True, text=True)
    assert done.returncode in (0, 4), done.stderr


def measured(sinew, demo, out, cameras, limits, seed):
    inputs = ["--calibration", demo / "Calib.toml", "--keypoints", demo / "keypoints", "--layout", "BODY_25B"]
    rest = ["--fps", "30", "--cameras", CAMERAS[cameras], "--people", "1", "--seed", str(seed), "--no-progress"]
    run([sinew, "track", *inputs, *rest, "--joint-limits", limits, "--force", "-o", out])
    truth, found = points(demo / "truth.trc"), points(out / "markers.trc")
    expected, ours = angles(truth), intervals(out / "angles.csv")
    row = {}
    for name, words in NAMES.items():
        sides = [(around(ours[link + name] - expected[link + name][:, None])).T for link in ("r_", "l_")]
        row[f"{words}: error, °"] = np.mean([np.sqrt((mean**2).mean()) for mean, _, _ in sides])
        row[f"{words}: inside 90 %, %"] = 100 * np.mean([((low <= 0) & (high >= 0)).mean() for _, low, high in sides])
    apart = lambda names: 1000 * np.mean([np.linalg.norm(found[s + n] - truth[s + n], axis=-1) for n in names for s in "RL"])
    row["joints of the limbs: distance, mm"] = apart(LIMBS)
    row["feet: distance, mm"] = apart(FEET)
    row["frames with R-hat above 1.05"] = json.loads((out / "summary.json").read_text())["diagnostics"]["r_hat"][
        "frames_above_1_05"
    ]
    return row


def with_error(values):
    return f"{np.mean(values):.1f} ± {np.std(values, ddof=1) / np.sqrt(len(values)):.1f}".replace("-", "−")


def main():
    sinew, out = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    seeds = range(1, 1 + int(sys.argv[3] if len(sys.argv) > 3 else 10))
    rows = {(cameras, limits): [] for cameras in CAMERAS for limits in ("off", "on")}
    for seed in seeds:
        demo = out / f"demo-{seed}"
        run([sinew, "demo", "--seed", str(seed), "-o", demo, "--force", "--no-progress"])
        for cameras, limits in rows:
            place = out / f"{seed}-{cameras}-{limits}"
            rows[cameras, limits].append(measured(sinew, demo, place, cameras, limits, seed))
    print("| cameras | what | off | on | on less off |\n|---|---|---|---|---|")
    for cameras in CAMERAS:
        for what in rows[cameras, "off"][0]:
            off, on = (np.array([row[what] for row in rows[cameras, limits]]) for limits in ("off", "on"))
            print(f"| {cameras} | {what} | {with_error(off)} | {with_error(on)} | {with_error(on - off)} |")


main()
