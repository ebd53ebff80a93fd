"""What some frames of delay are worth: error and coverage of `sinew track --lag-frames K` on simulated walkers.

    python3 crates/sinew-studies/peers/live_lag.py target/release/sinew --seeds 20 > lag.md

Each seed is a recording of its own (`sinew simulate --seed N`): noise of the keypoints, and errors that last. It is set
up once, tracked with every lag and with `--smooth`, and compared with the true places of the limbs' joints. The numbers
are taken from joints.csv and truth.trc with nothing of the program in between. The table has means over seeds with
standard errors of these means.

Criteria, written down before the first run:

1. The mean error falls from 0 to 2, 5 and 10 frames and to the smoother, each difference paired by seed.
2. Five frames gain at least half of what the smoother gains.
3. Coverage of the 90 % intervals lies between 85 and 95 % at every lag.
"""

import argparse
import csv
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

JOINTS = [side + joint for side in "RL" for joint in ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")]
LAGS = [0, 2, 5, 10]
WARM_UP = 10
LEVEL = 0.90


def truth(path):
    """True places by joint: frames of (x, y, z), z up; a TRC file has y up."""
    rows = [line.split("\t") for line in path.read_text().splitlines()]
    names = [name for name in rows[3] if name][2:]
    values = [[float(x) for x in row[2:] if x] for row in rows[5:] if len(row) > 3]
    place = lambda row, k: (row[3 * k + 2], row[3 * k], row[3 * k + 1])
    return {joint: [place(row, names.index(joint)) for row in values] for joint in JOINTS}


def judged(folder, true):
    """Mean error, mm; share of true coordinates inside the intervals; mean half-width, mm; roughness, mm."""
    errors, inside, widths, track = [], [], [], {joint: [] for joint in JOINTS}
    with open(folder / "joints.csv") as file:
        for row in csv.DictReader(file):
            frame, joint = int(row["frame"]), row["joint"]
            if joint not in true:
                continue
            mean = [float(row[f"{axis}_mean_m"]) for axis in "xyz"]
            track[joint].append(mean)
            if frame < WARM_UP:
                continue
            there = true[joint][frame]
            errors.append(1e3 * math.dist(mean, there))
            for axis, x in zip("xyz", there):
                low, high = float(row[f"{axis}_q05_m"]), float(row[f"{axis}_q95_m"])
                inside.append(low <= x <= high)
                widths.append(1e3 * (high - low) / 2)
    second = [
        1e3 * math.dist([a + c - 2 * b for a, b, c in zip(*three)], [0, 0, 0])
        for path in track.values()
        for three in zip(path[WARM_UP:], path[WARM_UP + 1:], path[WARM_UP + 2:])
    ]
    share = lambda values: sum(values) / len(values)
    return share(errors), 100 * share(inside), share(widths), share(second)


def mean_and_error(values):
    mean = sum(values) / len(values)
    variance = sum((x - mean) ** 2 for x in values) / (len(values) - 1)
    return mean, math.sqrt(variance / len(values))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--fps", type=float, default=60)
    parser.add_argument("--duration", type=float, default=3)
    asked = parser.parse_args()
    runs = {f"{lag} frames": ["--lag-frames", str(lag)] for lag in LAGS} | {"all frames (`--smooth`)": ["--smooth"]}
    found = {name: [] for name in runs}
    for seed in range(1, asked.seeds + 1):
        root = Path(tempfile.mkdtemp())

        def sinew(*arguments):
            command = [asked.program, *map(str, arguments), "--force", "-qq"]
            done = subprocess.run(command, capture_output=True, text=True)
            # 4: a diagnostic failed, and the results are there.
            assert done.returncode in (0, 4), done.stderr

        sinew("simulate", "-o", root / "walk", "--seed", seed, "--fps", asked.fps, "--duration", asked.duration)
        true = truth(root / "walk/truth.trc")
        track = ["track", "--calibration", root / "walk/Calib.toml", "--keypoints", root / "walk/keypoints"]
        track += ["--layout", "BODY_25B", "--fps", asked.fps, "--seed", seed]
        setup = []
        for name, more in runs.items():
            sinew(*track, *setup, *more, "-o", root / "out")
            if not setup:
                shutil.copy(root / "out/setup.toml", root / "setup.toml")
                setup = ["--setup", root / "setup.toml"]
            found[name].append(judged(root / "out", true))
        shutil.rmtree(root)
        print(f"seed {seed}", *(f"{found[name][-1][0]:.2f}" for name in runs), file=sys.stderr, flush=True)

    print("| frames of delay | error, mm | coverage of 90 %, % | half-width, mm | second difference, mm |")
    print("|---|---|---|---|---|")
    for name, values in found.items():
        cells = ["{:.2f} ± {:.2f}".format(*mean_and_error([value[k] for value in values])) for k in range(4)]
        print(f"| {name} | " + " | ".join(cells) + " |")
    names = list(runs)
    errors = lambda name: [value[0] for value in found[name]]
    steps = [mean_and_error([b - a for a, b in zip(errors(x), errors(y))]) for x, y in zip(names, names[1:])]
    print("\nchange of the error from row to row, mm:", ", ".join(f"{m:+.3f} ± {e:.3f}" for m, e in steps))
    mean = lambda name: mean_and_error(errors(name))[0]
    gained = (mean(names[0]) - mean("5 frames")) / (mean(names[0]) - mean(names[-1]))
    print(f"five frames gain {100 * gained:.0f} % of what the smoother gains")
    coverages = [mean_and_error([value[1] for value in found[name]])[0] for name in names]
    print("1:", "holds" if all(m < 0 for m, _ in steps) else "FAILS", end=", ")
    print("2:", "holds" if gained >= 0.5 else "FAILS", end=", ")
    print("3:", "holds" if all(85 <= c <= 95 for c in coverages) else "FAILS")


if __name__ == "__main__":
    main()
