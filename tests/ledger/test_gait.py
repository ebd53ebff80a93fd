"""Coverage of the intervals of `sinew gait`, on result folders that the test writes.

A walker whose feet are known as formulas; the truth is one more draw of the law of the folder's draws, so that 90 % of the intervals must hold it.
"""

import json
import re

import numpy as np
import pandas as pd
import pytest
import zarr

RATE_HZ, SECONDS, DRAWS, WALKS = 60.0, 5.0, 64, 40
STRIDE_S, STRIDE_M, STANCE, STEP_WIDTH_M, FOOT_M = 1.1, 1.3, 0.62, 0.12, 0.18
ERROR_M, ERROR_S, SHIFT_M = 0.006, 0.05, 0.02
BELOW_DEG, ABOVE_DEG = 3.0, 4.5
POINTS = ["LHip", "RHip", "LHeel", "RHeel", "LBigToe", "RBigToe"]
SPEED = STRIDE_M / STRIDE_S


def along(time_s, side):
    """Where a foot is on its way, m: it stands for a share of the cycle, then swings with a speed that begins and ends at zero. A swing ends at a whole number of cycles."""
    cycles = time_s / STRIDE_S - 0.5 * side
    whole = np.floor(cycles)
    swing = np.clip((cycles - whole - STANCE) / (1 - STANCE), 0, 1)
    return STRIDE_M * (whole + swing - np.sin(2 * np.pi * swing) / (2 * np.pi) + 0.5 * side)


def extrema(side):
    """Times at which heel and toe are farthest ahead of and behind the pelvis: the swing's speed is the pelvis's there."""
    turn = np.arccos(1 - (1 - STANCE)) / (2 * np.pi)
    start = STRIDE_S * (np.arange(-1, 12) + 0.5 * side)
    swing = STRIDE_S * (1 - STANCE)
    return {"heel_strike": start + STRIDE_S - turn * swing, "toe_off": start + STANCE * STRIDE_S + turn * swing}


def true_path(times):
    """Places of the points, frames × points × 3: they walk along x."""
    paths = []
    for name in POINTS:
        side = 0 if name[0] == "L" else 1
        y = STEP_WIDTH_M * (0.5 - side)
        x = along(times, side) + (FOOT_M if name.endswith("BigToe") else 0.0)
        if name.endswith("Hip"):
            x = SPEED * times + 0.2
        paths.append(np.stack([x, np.full_like(x, y), np.full_like(x, 0.9 if name.endswith("Hip") else 0.05)], -1))
    return np.stack(paths, 1)


def errors(rng, frames):
    """A draw of the errors: a shift of all, and for each point an autoregression."""
    kept = np.exp(-1 / (ERROR_S * RATE_HZ))
    own = np.empty((frames, len(POINTS), 3))
    own[0] = rng.normal(size=own[0].shape)
    for frame in range(1, frames):
        own[frame] = kept * own[frame - 1] + np.sqrt(1 - kept**2) * rng.normal(size=own[0].shape)
    return ERROR_M * own + SHIFT_M * rng.normal(size=(1, 1, 3))


def write(folder, rng, times):
    """A smoothed run's folder, whose middle is the truth less a draw of its errors."""
    folder.mkdir()
    path = true_path(times)
    middle = path - errors(rng, len(times))
    draws = np.stack([middle + errors(rng, len(times)) for _ in range(DRAWS)])
    numbers = np.arange(len(times))
    pd.DataFrame({"frame": numbers, "time_s": times}).to_csv(folder / "frames.csv", index=False)
    flat = draws.mean(0).reshape(-1, 3)
    table = {"frame": np.repeat(numbers, len(POINTS)), "joint": POINTS * len(times)}
    pd.DataFrame(table | {f"{axis}_mean_m": flat[:, k] for k, axis in enumerate("xyz")}).to_csv(folder / "joints.csv", index=False)
    (folder / "summary.json").write_text(json.dumps({"complete": True, "kind": "smoothed"}))
    knee = knee_deg(times)
    rows = "\n".join(f"{t}\t{a}" for t, a in zip(times, knee))
    (folder / "angles.mot").write_text(f"Coordinates\nversion=1\nnRows={len(times)}\nnColumns=2\ninDegrees=yes\n\nendheader\ntime\tknee_angle_r\n{rows}\n")
    ends = {"name": "knee_angle_r", "mean_deg": knee, "q05_deg": knee - BELOW_DEG, "q95_deg": knee + ABOVE_DEG}
    pd.DataFrame({"frame": numbers, "time_s": times} | ends).to_csv(folder / "angles.csv", index=False)
    array = zarr.create_array(str(folder / "posterior.zarr/posterior/marker_position"), shape=(1, *draws.shape), chunks=(1, DRAWS, 64, len(POINTS), 3), dtype="float32", compressors=None, chunk_key_encoding={"name": "default", "separator": "."})
    array[:] = draws[None]


def knee_deg(times):
    return 25 + 20 * np.sin(2 * np.pi * times / STRIDE_S) + 4 * np.sin(6 * np.pi * times / STRIDE_S)


@pytest.fixture(scope="module")
def walks(call, tmp_path_factory):
    """Tables of `sinew gait` for each walk."""
    top = tmp_path_factory.mktemp("gait")
    times = np.arange(int(RATE_HZ * SECONDS)) / RATE_HZ
    found = []
    for seed in range(WALKS):
        folder = top / str(seed)
        write(folder, np.random.default_rng(seed), times)
        call(top, "gait", seed)
        found.append({name: pd.read_csv(folder / f"gait_{name}.csv") for name in ("events", "parameters", "cycles")})
    return found


def share(hits):
    """Share of intervals that hold the truth, with its standard error over walks."""
    by_walk = np.array([np.mean(walk) for walk in hits])
    return by_walk.mean(), by_walk.std(ddof=1) / np.sqrt(len(by_walk))


def steady(times_s):
    """Not within half a cycle of the recording's ends."""
    return (times_s > 0.5 * STRIDE_S) & (times_s < SECONDS - 0.5 * STRIDE_S)


@pytest.mark.parametrize("event", ["heel_strike", "toe_off"])
def test_events_are_inside_their_intervals(walks, event):
    hits, away, widths = [], [], []
    for walk in walks:
        own = walk["events"][(walk["events"].event == event) & steady(walk["events"].time_s)]
        truth = np.array([min(extrema(0 if row.side == "left" else 1)[event], key=lambda t: abs(t - row.time_s)) for row in own.itertuples()])
        expected = sum(steady(extrema(side)[event]).sum() for side in (0, 1))
        assert abs(len(own) - expected) <= 1
        assert set(own.point) == ({"LHeel", "RHeel"} if event == "heel_strike" else {"LBigToe", "RBigToe"})
        assert set(own.definition) == {f"point farthest {'ahead of' if event == 'heel_strike' else 'behind'} the pelvis (not contact)"}
        assert np.allclose(own.frame, own.time_s * RATE_HZ, atol=1e-6)
        hits.append((own.time_q05_s < truth) & (truth < own.time_q95_s))
        away += list(own.time_s - truth)
        widths += list(own.time_q95_s - own.time_q05_s)
    inside, error = share(hits)
    assert 0.85 - 2 * error < inside < 0.95 + 2 * error, (inside, error)
    # As wide as need be: 90 % of a Gaussian of the errors that there are.
    assert 0.7 < np.mean(widths) / (3.29 * np.std(away)) < 1.4
    assert abs(np.mean(away)) < 0.005, np.mean(away)


TRUTH = {
    "stride_length_m": STRIDE_M,
    "step_length_m": STRIDE_M / 2,
    "step_width_m": STEP_WIDTH_M,
    "step_time_s": STRIDE_S / 2,
    "stride_time_s": STRIDE_S,
    "cadence_per_min": 120 / STRIDE_S,
    "speed_m_per_s": SPEED,
}


@pytest.mark.parametrize("parameter", TRUTH)
def test_parameters_are_inside_their_intervals(walks, parameter):
    stem, unit = re.fullmatch(r"(.*?)_(m|s|per_min|m_per_s)", parameter).groups()
    low, high = (f"{stem}_{end}_{unit}" for end in ("q05", "q95"))
    hits, away, widths = [], [], []
    for walk in walks:
        table = walk["parameters"]
        own = table[(table.row == "stride") & table[parameter].notna()]
        hits.append(own[low].lt(TRUTH[parameter]) & own[high].gt(TRUTH[parameter]))
        away += list(own[parameter] - TRUTH[parameter])
        widths += list(own[high] - own[low])
    inside, error = share(hits)
    assert 0.85 - 2 * error < inside < 0.95 + 2 * error, (inside, error)
    assert 0.7 < np.mean(widths) / (3.29 * np.std(away)) < 1.4, np.mean(widths) / (3.29 * np.std(away))


def test_cycles_are_the_angle_over_the_cycle(walks):
    """From heel strike to heel strike, wherever they were found: the angle's own formula, shifted."""
    for walk in walks[:3]:
        strikes = walk["events"].query("event == 'heel_strike' and side == 'right'").time_s.to_numpy()
        own = walk["cycles"].query("side == 'right' and angle == 'knee_angle_r'")
        assert list(own.percent) == list(range(101)) and (own.cycles == len(strikes) - 1).all()
        share_ = np.arange(101)[:, None] / 100
        cycles = knee_deg(strikes[:-1] + share_ * np.diff(strikes))
        assert np.allclose(own.mean_deg, cycles.mean(1), atol=0.2)
        assert np.allclose(own.sd_deg, cycles.std(1, ddof=1), atol=0.2)
        assert np.allclose(own.mean_deg - own.q05_deg, BELOW_DEG, atol=1e-4)
        assert np.allclose(own.q95_deg - own.mean_deg, ABOVE_DEG, atol=1e-4)
