"""Points in space: `joints.csv`, `keypoints.csv`, `markers_sd.csv`, from the draws of `posterior.zarr`."""

import numpy as np
from ledger import known

# Draws are stored in single precision: at 2 m an ulp is 2.4e-7 m, some 3e-5 of an sd of 8 mm.
OF_AN_SD = 1e-4
MOMENTS = tuple(f"{axis}_{what}_m" for what in ("mean", "sd", "q05", "q95") for axis in "xyz")
WITHIN = tuple(f"{axis}_sd_within_m" for axis in "xyz")
SOURCE = "the draws of `posterior.zarr`, by NumPy"


def columns(results, file, row, what):
    """A number of the points by axis, frames × points × 3."""
    return np.stack([results.of(file, f"{axis}_{what}_m", row)[0] for axis in "xyz"], -1)


def names_are(results, file, row, stored):
    """Every frame has every name once, in one order."""
    table = results.tables[file]
    assert list(table[row]) == list(results.draws[stored]) * results.frames


def follow(results, file, row, variable, stored):
    names_are(results, file, row, stored)
    draws = results.draws[variable][0].astype(float)
    sd = draws.std(0)
    expected = {
        "mean": draws.mean(0),
        "sd": sd,
        "q05": np.quantile(draws, 0.05, axis=0, method="inverted_cdf"),
        "q95": np.quantile(draws, 0.95, axis=0, method="inverted_cdf"),
    }
    for what, value in expected.items():
        assert (abs(columns(results, file, row, what) - value) < OF_AN_SD * sd).all(), what


@known("joints.csv", "joint", *MOMENTS, source=SOURCE)
def joints_follow_from_draws(results):
    follow(results, "joints.csv", "joint", "marker_position", "marker")


@known("keypoints.csv", "keypoint", *MOMENTS, source=SOURCE)
def keypoints_follow_from_draws(results):
    follow(results, "keypoints.csv", "keypoint", "keypoint_position", "keypoint")


@known("joints.csv", *WITHIN, source="of a set-up in which nothing lasts, the spread of the draws", runs=("plain",))
def nothing_lasts_and_all_spread_is_within(results):
    names_are(results, "joints.csv", "joint", "marker")
    within, sd = (columns(results, "joints.csv", "joint", what) for what in ("sd_within", "sd"))
    draws = results.draws["marker_position"][0].astype(float)
    assert (abs(sd - draws.std(0)) < OF_AN_SD * sd).all()
    assert (abs(within - sd) < 1e-9).all()


@known("markers_sd.csv", "*_sd_m", source="root mean square of the three of `joints.csv`")
def weights_are_of_the_spread_within_the_run(results):
    within = columns(results, "joints.csv", "joint", "sd_within")
    names = list(results.draws["marker"])
    table = results.tables["markers_sd.csv"]
    found = [column.removesuffix("_sd_m") for column in table if column.endswith("_sd_m")]
    assert sorted(found) == sorted(names)
    expected = np.sqrt((within**2).mean(-1))[:, [names.index(name) for name in found]]
    assert np.allclose(table[[f"{name}_sd_m" for name in found]], expected, rtol=1e-9, atol=0)
