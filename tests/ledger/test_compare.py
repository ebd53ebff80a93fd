"""`sinew compare` on result folders and references that the test writes: its table by NumPy, and what its intervals hold over many pairs whose truth is known."""

import json

import numpy as np
import pandas as pd
import pytest

RATE_HZ, FRAMES, PAIRS = 60.0, 240, 40
POINTS = ["LHip", "RHip", "LKnee", "RKnee", "LAnkle", "RAnkle"]
# Errors of a coordinate, forgotten after some frames; each has its own bias.
ERROR_M, KEPT, BIAS_M = 0.008, 0.8, 0.01
SD_M, WITHIN = 0.009, 0.8
TIMES = np.arange(FRAMES) / RATE_HZ


def path(times):
    """Places of a walker's points, frames × points × 3."""
    places = []
    for k, name in enumerate(POINTS):
        phase = 2 * np.pi * times / 1.1 + (np.pi if name[0] == "R" else 0.0)
        swing = 0.05 * (k // 2)
        places.append(np.stack([1.1 * times + swing * np.sin(phase), np.full_like(times, 0.1 if name[0] == "L" else -0.1), 0.9 - 0.4 * (k // 2) + 0.2 * swing * np.cos(2 * phase)], -1))
    return np.stack(places, 1)


def autoregression(rng, shape):
    found = np.empty(shape)
    found[0] = rng.normal(size=shape[1:])
    for frame in range(1, shape[0]):
        found[frame] = KEPT * found[frame - 1] + np.sqrt(1 - KEPT**2) * rng.normal(size=shape[1:])
    return found


def write_result(folder, means):
    """What `compare` reads of a run, with the same spreads everywhere."""
    folder.mkdir(exist_ok=True)
    numbers = np.arange(FRAMES)
    flat = means.reshape(-1, 3)
    table = {"frame": np.repeat(numbers, len(POINTS)), "time_s": np.repeat(TIMES, len(POINTS)), "person": 0, "joint": POINTS * FRAMES}
    for k, axis in enumerate("xyz"):
        table |= {f"{axis}_mean_m": flat[:, k], f"{axis}_sd_m": SD_M, f"{axis}_sd_within_m": SD_M * WITHIN}
        table |= {f"{axis}_q05_m": flat[:, k] - 1.645 * SD_M, f"{axis}_q95_m": flat[:, k] + 1.645 * SD_M}
    pd.DataFrame(table).assign(observed=1, quality=2).to_csv(folder / "joints.csv", index=False)
    pd.DataFrame({"frame": numbers, "time_s": TIMES, "person": 0, "observed": 1, "quality": 2}).to_csv(folder / "frames.csv", index=False)
    (folder / "summary.json").write_text(json.dumps({"complete": True, "kind": "filtered", "fps": RATE_HZ}))


def write_reference(file, places):
    """A TRC file: its Y is up, its Z where x was."""
    head = f"PathFileType\t4\t(X/Y/Z)\tr.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n{RATE_HZ}\t{RATE_HZ}\t{FRAMES}\t{len(POINTS)}\tm\t{RATE_HZ}\t1\t{FRAMES}\n"
    names = "Frame#\tTime\t" + "".join(f"{name}\t\t\t" for name in POINTS) + "\n"
    axes = "\t\t" + "\t".join(f"{axis}{k + 1}" for k in range(len(POINTS)) for axis in "XYZ") + "\n\n"
    rows = "".join(f"{n + 1}\t{t:.6f}\t" + "\t".join(f"{x:.9f}" for x in frame[:, [1, 2, 0]].reshape(-1)) + "\n" for n, (t, frame) in enumerate(zip(TIMES, places)))
    file.write_text(head + names + axes + rows)


@pytest.fixture(scope="module")
def compared(call, tmp_path_factory):
    """Compares a result with a reference; the table and what was found beside it."""
    folder = tmp_path_factory.mktemp("compare")

    def run(ours, reference, *options):
        write_result(folder / "result", ours)
        write_reference(folder / "reference.trc", reference)
        call(folder, "compare", "result", "reference.trc", *options, "--force", "-o", "beside")
        return pd.read_csv(folder / "beside/comparison.csv"), json.loads((folder / "beside/comparison.json").read_text())

    return run


def of_point(table, point, axis):
    return table[(table.name == point) & (table.axis == axis)].iloc[0]


def test_differences_are_what_they_are(compared):
    rng = np.random.default_rng(1)
    truth = path(TIMES)
    ours = truth + BIAS_M * rng.normal(size=(1, len(POINTS), 3)) + ERROR_M * autoregression(rng, truth.shape)
    table, _ = compared(ours, truth, "--align", "none")
    away = ours - truth
    within = away - away.mean((0, 1))
    for k, name in enumerate(POINTS):
        for axis, letter in enumerate("xyz"):
            row, own = of_point(table, name, letter), away[:, k, axis]
            # The variance of the mean, of as many independent frames as the differences are worth, is counted.
            sd = own.std() / np.sqrt(1 - 1 / row.worth)
            expected = {"count": FRAMES, "bias_m": own.mean(), "sd_m": sd, "rms_m": np.sqrt((own**2).mean())}
            expected |= {"mean_ours_m": ours[:, k, axis].mean(), "mean_reference_m": truth[:, k, axis].mean()}
            expected |= {"limit_low_m": own.mean() - 1.96 * sd, "limit_high_m": own.mean() + 1.96 * sd}
            for z, share in ((0.674490, 50), (1.644854, 90), (1.959964, 95)):
                expected[f"inside_{share}"] = (abs(own) <= z * SD_M).mean()
                expected[f"inside_within_{share}"] = (abs(within[:, k, axis]) <= z * SD_M * WITHIN).mean()
            for what, value in expected.items():
                assert abs(row[what] - value) < 2e-5 + 1e-4 * abs(value), (name, letter, what, row[what], value)


def test_intervals_hold_bias_and_limits(compared):
    """Over pairs, with errors that last some frames: 95 % of the intervals hold the bias and the limits of agreement, whose values the law of the errors gives."""
    rng = np.random.default_rng(2)
    truth = path(TIMES)
    inside = {"bias": [], "limit_low": [], "limit_high": []}
    widths = []
    for _ in range(PAIRS):
        bias = BIAS_M * rng.normal(size=(1, len(POINTS), 3))
        table, _ = compared(truth + bias + ERROR_M * autoregression(rng, truth.shape), truth, "--align", "none")
        for k, name in enumerate(POINTS):
            for axis, letter in enumerate("xyz"):
                row, true = of_point(table, name, letter), bias[0, k, axis]
                for what, value in (("bias", true), ("limit_low", true - 1.96 * ERROR_M), ("limit_high", true + 1.96 * ERROR_M)):
                    inside[what].append(row[f"{what}_low_m"] <= value <= row[f"{what}_high_m"])
                widths.append(row.bias_high_m - row.bias_low_m)
    shares = {what: np.mean(held) for what, held in inside.items()}
    # Independent series: 3 standard errors of a share of 0.95 of 720 are 0.024; intervals of few independent frames may hold 3 % less.
    assert all(0.90 < share < 0.98 for share in shares.values()), shares
    # No wider than need be: the error of a mean of an autoregression.
    exact = 2 * 1.96 * ERROR_M * np.sqrt((1 + KEPT) / (1 - KEPT) / FRAMES)
    assert 0.9 < np.median(widths) / exact < 1.25, np.median(widths) / exact


def test_the_clock_is_found_as_surely_as_stated(compared):
    """The reference is late by what is known: 90 % of the offsets lie within 1.645 of the stated standard deviations, and these are not wider than need be."""
    rng = np.random.default_rng(3)
    away = []
    for _ in range(PAIRS):
        late = rng.uniform(-0.05, 0.05)
        truth = path(TIMES)
        _, found = compared(truth + ERROR_M * autoregression(rng, truth.shape), path(TIMES - late), "--align", "time")
        offset, sd = (found["alignment"][key] for key in ("offset_s", "offset_sd_s"))
        away.append((offset - late) / sd)
    away = np.array(away)
    # 40 squares: the sd of their mean is 0.22.
    assert 0.4 < (away**2).mean() < 1.7, (away**2).mean()
    # Of 40 with probability 0.9, four standard errors are 0.19.
    assert (abs(away) < 1.645).mean() > 0.71, (abs(away) < 1.645).mean()
