"""Means and spreads of a method that weighs its particles, with a set-up in which nothing lasts: draws are taken by weight, and agree up to Monte Carlo error."""

import numpy as np
from angles import shown, state_draws
from ledger import known
from points import MOMENTS, columns, names_are
from rotations import joint_angles

# Standard errors; of some thousand numbers one in a million is farther away by chance.
ERRORS = 5
# What is left of single precision.
METRES, DEGREES = 2e-6, 2e-4
SOURCE = "draws taken by weight, within five Monte Carlo errors"
RUNS = ("weighted",)


def agree(means, sds, lows, highs, draws, stored, what):
    """Of draws × numbers: the mean, the standard deviation, and how many draws lie below the ends of the interval, which may be draws themselves, to the precision in which they are stored."""
    count = len(draws)
    error = draws.std(0) / np.sqrt(count)
    assert (abs(means - draws.mean(0)) < ERRORS * error).all(), what
    if sds is not None:
        fourth = ((draws - draws.mean(0)) ** 4).mean(0)
        of_variance = np.sqrt(np.maximum(fourth - draws.var(0) ** 2, 0) / count)
        assert (sds >= 0).all() and (abs(sds**2 - draws.var(0)) < ERRORS * of_variance).all(), what
    for end, share in ((lows, 0.05), (highs, 0.95)):
        below, at_most = (draws < end - stored).mean(0), (draws <= end + stored).mean(0)
        slack = ERRORS * np.sqrt(0.05 * 0.95 / count)
        assert (below < share + slack).all() and (at_most > share - slack).all(), (what, share)


@known("joints.csv", "joint", *MOMENTS, source=SOURCE, runs=RUNS)
def joints_of_weighted_particles(results):
    names_are(results, "joints.csv", "joint", "marker")
    draws = results.draws["marker_position"][0].astype(float)
    agree(*(columns(results, "joints.csv", "joint", what) for what in ("mean", "sd", "q05", "q95")), draws, METRES, "joints")


def named_state(results):
    """Draws of the state as `state.csv` shows it, draws × frames × degrees of freedom, whose names and units are those of the table."""
    draws, names = state_draws(results)
    table = results.tables["state.csv"]
    assert list(table.name) == names * results.frames
    assert list(table.unit) == ["m" if ".t" in name else "deg" for name in names] * results.frames
    return np.stack([shown(names, draw) for draw in draws])


@known("state.csv", "name", "unit", "mean", "q05", "q95", source=SOURCE, runs=RUNS)
def state_of_weighted_particles(results):
    mean, low, high = (results.of("state.csv", what, "name")[0] for what in ("mean", "q05", "q95"))
    agree(mean, None, low, high, named_state(results), DEGREES, "state")


def named_angles(results, draws, names):
    """Angles of draws of the state, draws × frames × angles, whose names are those of `angles.csv`, and the names."""
    expected = joint_angles(names, draws)
    found = results.of("angles.csv", "mean_deg", "name")[1]
    assert sorted(found) == sorted(expected) and list(results.tables["angles.csv"].name) == found * results.frames
    return np.stack([expected[name] for name in found], -1), found


@known("angles.csv", "name", "mean_deg", "q05_deg", "q95_deg", source=SOURCE, runs=RUNS)
def angles_of_weighted_particles(results):
    series, _ = named_angles(results, *state_draws(results))
    mean, low, high = (results.of("angles.csv", f"{what}_deg", "name")[0] for what in ("mean", "q05", "q95"))
    series = mean + (series - mean + 180) % 360 - 180
    agree(mean, None, low, high, series, DEGREES, "angles")
