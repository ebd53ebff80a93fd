"""The run as a whole: `summary.json`, and what the terminal says."""

import numpy as np
from frames import CHAINS, cameras_that_saw
from ledger import known
from points import columns

UPDATES = 32
ALL = ("filtered", "smoothed", "plain")
SOURCES = ("frames", "cameras", "lengths", "places", "biases", "lags")


def number(results, key):
    return results.tables["summary.json"][key].iloc[0]


def near(results, key, expected):
    assert np.isclose(number(results, key), expected, rtol=1e-5, atol=1e-9), (key, number(results, key), expected)


def is_rounded(said, exact, places):
    """Whether a number is the nearest with so many decimals."""
    assert said == float(f"{exact:.{places}f}"), (said, exact)


@known("summary.json", "fps", "frames.*", "frame_count", "observed_frames", "restarted_frames", "seed", "degrees_of_freedom", "schema_version", source="the request; frames in which a camera has a keypoint; degrees of freedom in `posterior.zarr`", runs=ALL)
def summary_counts(results):
    near(results, "fps", results.fps)
    near(results, "frames.0", results.numbers[0])
    near(results, "frames.1", results.numbers[-1] + 1)
    near(results, "frame_count", results.frames)
    near(results, "observed_frames", (cameras_that_saw(results) > 0).sum())
    near(results, "restarted_frames", 0)
    near(results, "seed", 1)
    near(results, "schema_version", 1)
    near(results, "degrees_of_freedom", len(results.draws["dof"]) + 3)


@known("summary.json", "cameras.*", source="frames with a keypoint of the camera; median of `frames.csv`; offset of `setup.toml`", runs=ALL)
def summary_of_cameras(results):
    pixels = np.isfinite(results.seen["pixel"][..., 0]).any(-1)
    for index, name in enumerate(results.seen["camera"]):
        near(results, f"cameras.{name}.frames", pixels[:, index].sum())
        near(results, f"cameras.{name}.residual_px", results.tables["frames.csv"][f"residual_{name}_px"].median())
        offset = next(camera["offset_px"] for camera in results.setup["camera"] if camera["name"] == name)
        for axis in (0, 1):
            near(results, f"cameras.{name}.offset_px.{axis}", offset[axis])


@known("summary.json", "diagnostics.*", source="medians, quantiles, sums of `frames.csv` by NumPy; 16 chains of 32 updates a frame", runs=("filtered", "plain"))
def summary_of_diagnostics(results):
    frames = results.tables["frames.csv"]
    # Without a person in view there is nothing to update by.
    near(results, "diagnostics.acceptance", frames.acceptance.mean())
    near(results, "diagnostics.r_hat.median", frames.r_hat.median())
    near(results, "diagnostics.r_hat.p95", frames.r_hat.quantile(0.95))
    near(results, "diagnostics.r_hat.frames_above_1_05", (frames.r_hat > 1.05).sum())
    near(results, "diagnostics.energy_fraction", frames.e_bfmi.median())
    near(results, "diagnostics.ess_median", frames.ess.median())
    near(results, "diagnostics.ess_least", frames.ess.min())
    near(results, "diagnostics.divergences", frames.divergences.sum())
    near(results, "diagnostics.trajectories", CHAINS * UPDATES * results.frames)
    near(results, "diagnostics.log_evidence", frames.log_evidence.sum())


@known("summary.json", "uncertainty.joints.*", source="the mean variance of `joints.csv`; shares add to one", runs=("filtered", "smoothed"))
def summary_of_uncertainty(results):
    sds = columns(results, "joints.csv", "joint", "sd")
    for k, name in enumerate(results.draws["marker"]):
        key = f"uncertainty.joints.{name}"
        near(results, f"{key}.sd_m", np.sqrt((sds[:, k] ** 2).mean()))
        assert abs(sum(number(results, f"{key}.{source}") for source in SOURCES) - 1) < 1e-6, name


@known("terminal", "*.residual", "*.offset_*", "*.frames", source="`summary.json`, rounded", runs=ALL)
def terminal_says_of_cameras_what_the_summary_says(results):
    said = results.tables["terminal"]
    for name in results.seen["camera"]:
        for what, key, places in (("residual", "residual_px", 1), ("offset_u", "offset_px.0", 1), ("offset_v", "offset_px.1", 1), ("frames", "frames", 0)):
            is_rounded(said[f"{name}.{what}"].iloc[0], number(results, f"cameras.{name}.{key}"), places)


@known("terminal", "R-hat.*", "effective size.*", "frames.*", source="`summary.json`, rounded", runs=("filtered", "plain"))
def terminal_says_of_diagnostics_what_the_summary_says(results):
    said = results.tables["terminal"].iloc[0]
    expected = {
        "R-hat.median": ("diagnostics.r_hat.median", 3),
        "R-hat.p95": ("diagnostics.r_hat.p95", 3),
        "R-hat.above": ("diagnostics.r_hat.frames_above_1_05", 0),
        "effective size.median": ("diagnostics.ess_median", 0),
        "frames.count": ("frame_count", 0),
        "frames.observed": ("observed_frames", 0),
    }
    for what, (key, places) in expected.items():
        is_rounded(said[what], number(results, key), places)


@known("terminal", "uncertainty.*", source="shares of `summary.json`, weighted by variances", runs=("filtered", "smoothed"))
def terminal_says_where_uncertainty_comes_from(results):
    said = results.tables["terminal"].iloc[0]
    variances = np.array([number(results, f"uncertainty.joints.{name}.sd_m") for name in results.draws["marker"]]) ** 2
    words = {"noise of each frame": "frames", "cameras": "cameras", "lengths of the body": "lengths", "places of keypoints": "places", "biases of detectors": "biases", "lags of the cameras": "lags"}
    for word, source in words.items():
        shares = np.array([number(results, f"uncertainty.joints.{name}.{source}") for name in results.draws["marker"]])
        is_rounded(said[f"uncertainty.{word}"], 100 * (shares * variances).sum() / variances.sum(), 0)
