"""What soft limits of joints change: coverage and error of hinge angles, distances of joints, on demos.

    python joint_limits.py SINEW OUT [SEEDS]      # numpy; prints a table in Markdown

Each demo is tracked with and without `--joint-limits on`, by four cameras and by the first alone, and from keypoints
without feet by four and by two. True angles are what the demo's true points have, by the definitions of opensim_ik.py.
Errors are root mean squares over the frames.
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

CASES = {
    "four": ("C1,C2,C3,C4", "BODY_25B"),
    "one": ("C1", "BODY_25B"),
    "four, no feet": ("C1,C2,C3,C4", "COCO_17"),
    "two, no feet": ("C1,C2", "COCO_17"),
}
LIMBS = ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")
FEET = ("BigToe", "SmallToe", "Heel")
NAMES = {"knee_angle_{}": "knee", "elbow_flex_{}": "elbow", "ankle_angle_{}": "ankle", "{}_foot_ry": "foot, sideways"}
FORWARD_DEG = -15


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
    for side, link, sign in (("R", "r", 1), ("L", "l", -1)):
        along = lambda a, b: unit(p[side + b] - p[side + a])
        between = lambda a, b: np.degrees(np.arccos(np.clip((a * b).sum(-1), -1, 1)))
        thigh, shin = along("Hip", "Knee"), along("Knee", "Ankle")
        out[f"knee_angle_{link}"] = between(thigh, shin)
        out[f"elbow_flex_{link}"] = between(along("Shoulder", "Elbow"), along("Elbow", "Wrist"))
        hinge = unit(np.cross(shin, thigh))
        sole = sign * unit(np.cross(p[side + "SmallToe"] - p[side + "Heel"], p[side + "BigToe"] - p[side + "Heel"]))
        x, y, z = ((axis * sole).sum(-1) for axis in (hinge, np.cross(-shin, hinge), -shin))
        out[f"ankle_angle_{link}"] = np.degrees(np.arctan2(-y, z))
        out[f"{link}_foot_ry"] = np.degrees(np.arcsin(x))
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


def without_feet(demo):
    """The keypoints of COCO, which are the first 17 of BODY_25B."""
    for path in (demo / "keypoints").glob("*/*.json"):
        frame = json.loads(path.read_text())
        for person in frame["people"]:
            person["pose_keypoints_2d"] = person["pose_keypoints_2d"][:51]
        shorter = demo / "COCO_17" / path.parent.name / path.name
        shorter.parent.mkdir(parents=True, exist_ok=True)
        shorter.write_text(json.dumps(frame))


def measured(sinew, demo, out, case, limits, seed):
    cameras, layout = CASES[case]
    keypoints = demo / ("keypoints" if layout == "BODY_25B" else layout)
    inputs = ["--calibration", demo / "Calib.toml", "--keypoints", keypoints, "--layout", layout]
    rest = ["--fps", "30", "--cameras", cameras, "--people", "1", "--seed", str(seed), "--no-progress"]
    run([sinew, "track", *inputs, *rest, "--joint-limits", limits, "--force", "-o", out])
    truth, found = points(demo / "truth.trc"), points(out / "markers.trc")
    expected, ours = angles(truth), intervals(out / "angles.csv")
    row = {}
    for name, words in NAMES.items():
        if name.format("r") not in ours:
            continue
        both = [name.format(link) for link in "rl"]
        sides = [(around(ours[side] - expected[side][:, None])).T for side in both]
        row[f"{words}: error, °"] = np.mean([np.sqrt((mean**2).mean()) for mean, _, _ in sides])
        row[f"{words}: inside 90 %, %"] = 100 * np.mean([((low <= 0) & (high >= 0)).mean() for _, low, high in sides])
    knees = [ours[f"knee_angle_{link}"][:, 0] < FORWARD_DEG for link in "rl"]
    row["knees bent forward by more than 15°, % of frames"] = 100 * np.mean(knees)
    apart = lambda names: 1000 * np.mean([np.linalg.norm(found[s + n] - truth[s + n], axis=-1) for n in names for s in "RL"])
    row["joints of the limbs: distance, mm"] = apart(LIMBS)
    if layout == "BODY_25B":
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
    rows = {(case, limits): [] for case in CASES for limits in ("off", "on")}
    for seed in seeds:
        demo = out / f"demo-{seed}"
        run([sinew, "demo", "--seed", str(seed), "-o", demo, "--force", "--no-progress"])
        without_feet(demo)
        for case, limits in rows:
            place = out / f"{seed}-{case.replace(', ', '-').replace(' ', '-')}-{limits}"
            rows[case, limits].append(measured(sinew, demo, place, case, limits, seed))
    print("| cameras | what | off | on | on less off |\n|---|---|---|---|---|")
    for case in CASES:
        for what in rows[case, "off"][0]:
            off, on = (np.array([row[what] for row in rows[case, limits]]) for limits in ("off", "on"))
            print(f"| {case} | {what} | {with_error(off)} | {with_error(on)} | {with_error(on - off)} |")


main()
