"""Tables of `sinew batch`: `groups.csv` from the draws of each trial's `posterior.zarr`, `summary.csv` from each trial's `summary.json`, by NumPy."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest
import results
from angles import state_draws
from rotations import joint_angles

FPS, TRIALS = 30.0, 3


@pytest.fixture(scope="module")
def study(call, tmp_path_factory):
    """A study of three short walks of three people, smoothed and gathered."""
    folder = tmp_path_factory.mktemp("batch")
    for trial in range(1, TRIALS + 1):
        call(folder, "simulate", "--duration", 0.4, "--seed", trial, "-o", f"made{trial}")
        place = folder / f"trials/P{trial}"
        place.mkdir(parents=True)
        shutil.copytree(folder / f"made{trial}/keypoints", place / "pose")
        shutil.copy(folder / f"made{trial}/Calib.toml", place)
        (place / "sinew.toml").write_text('keypoints = "pose"\ncalibration = "Calib.toml"\n')
    (folder / "trials/sinew.toml").write_text(f'root = true\nfps = {FPS}\nlayout = "BODY_25B"\nsmooth = true\npatience = 1\n')
    call(folder, "batch", "plan", "trials", "-o", "study")
    call(folder, "batch", "run", "study")
    call(folder, "batch", "gather", "study", "--by", "all")
    return folder / "study"


def trials(study):
    """Each trial's results."""
    read = []
    for trial in range(1, TRIALS + 1):
        folder = study / f"results/P{trial}"
        numbers = sorted(pd.read_csv(folder / "frames.csv").frame)
        read.append(results.read(folder, study.parent / f"trials/P{trial}/Calib.toml", "", FPS, numbers))
    return read


def circular_mean(degrees, axis=None):
    return np.degrees(np.angle(np.exp(1j * np.radians(degrees)).mean(axis)))


def test_groups_follow_from_draws(study):
    """By angle: the mean over time and the range of each draw, then over the trials draw by draw, the interval over the draws, and the spread between the trials' own means."""
    series = []
    for trial in trials(study):
        draws, names = state_draws(trial)
        angles = joint_angles(names, draws)
        series.append({name: np.unwrap(values, period=360, axis=1) for name, values in angles.items()})
    table = pd.read_csv(study / "groups.csv")
    assert set(table.angle) == set(series[0]) and set(table.trials) == {TRIALS}
    for row in table.itertuples():
        values = [trial[row.angle] for trial in series]
        if row.what == "mean over time":
            means = [value.mean(1) for value in values]
            means = [own + 360 * np.round((circular_mean(own) - own) / 360) for own in means]
        else:
            means = [np.ptp(value, axis=1) for value in values]
        over_trials = np.mean(means, axis=0)
        expected = {"mean_deg": over_trials.mean(), "q05_deg": np.quantile(over_trials, 0.05), "q95_deg": np.quantile(over_trials, 0.95), "sd_between_trials_deg": np.std([own.mean() for own in means], ddof=1)}
        for what, value in expected.items():
            assert abs(getattr(row, what) - value) < 2e-3 + 1e-4 * abs(value), (row.angle, row.what, what, getattr(row, what), value)


def test_a_row_a_trial(study):
    """What stands in the trials' own files; a trial whose chains disagree is doubtful, and says so."""
    table = pd.read_csv(study / "summary.csv")
    assert list(table.trial) == [f"P{trial}" for trial in range(1, TRIALS + 1)]
    for row, trial in zip(table.itertuples(), trials(study)):
        frames = trial.tables["frames.csv"]
        above = (frames.r_hat > 1.05).sum()
        counts = {"frames": len(frames), "observed_frames": (frames.quality > 0).sum(), "fps": FPS, "r_hat_frames_above_1_05": above, "divergences": frames.divergences.sum()}
        assert all(getattr(row, name) == count for name, count in counts.items()), counts
        assert abs(row.r_hat_median - frames.r_hat.median()) < 1e-5 and abs(row.ess_median - frames.ess.median()) < 1e-3
        is_doubtful = above > 0.05 * len(frames)
        assert row.state == ("doubtful" if is_doubtful else "done")
        assert not is_doubtful or f"in {above} of {len(frames)} frames" in row.why
        said = json.loads((study / f"results/{row.trial}/summary.json").read_text())
        assert row.warnings == len(said["warnings"])
