"""Degrees of freedom and angles of joints: `state.csv`, `angles.csv`, `angles.mot`."""

import numpy as np
from ledger import known
from rotations import joint_angles

DRAWS = "the draws of `posterior.zarr`, by NumPy and SciPy's rotations"
# Half a degree at single precision is far below this.
DEGREES = 1e-4


def quantile(draws, p):
    return np.quantile(draws, p, axis=0, method="inverted_cdf")


def state_draws(results):
    """Draws of the degrees of freedom in rad and m, draws × frames × dofs, with their names in the order of `state.csv`."""
    _, names = results.of("state.csv", "mean", "name")
    stored = [*(f"pelvis.t{axis}" for axis in results.draws["axis"]), *results.draws["dof"]]
    assert sorted(names) == sorted(stored)
    both = np.concatenate([results.draws["root"][0], results.draws["angle"][0]], -1).astype(float)
    return both[..., [stored.index(name) for name in names]], names


def shown(names, values):
    """Degrees where a degree of freedom is an angle."""
    return np.where([".t" in name for name in names], values, np.degrees(values))


@known("state.csv", "name", "unit", "q05", "q95", source=DRAWS)
def state_follows_from_draws(results):
    draws, names = state_draws(results)
    table = results.tables["state.csv"]
    assert list(table.name) == names * results.frames
    assert list(table.unit) == ["m" if ".t" in name else "deg" for name in names] * results.frames
    for what, p in (("q05", 0.05), ("q95", 0.95)):
        assert np.allclose(results.of("state.csv", what, "name")[0], shown(names, quantile(draws, p)), atol=DEGREES, rtol=1e-6)


def mean_state(results):
    """The mean state of `state.csv`, rad and m."""
    means, names = results.of("state.csv", "mean", "name")
    return np.where([".t" in name for name in names], means, np.radians(means)), names


@known("state.csv", "mean", source="the mean of the draws within four of its standard errors; the angles of `angles.mot`, by SciPy's rotations")
def the_mean_state_is_that_of_the_draws(results):
    draws, names = state_draws(results)
    means, _ = mean_state(results)
    error = draws.std(0) / np.sqrt(len(draws))
    assert (abs(means - draws.mean(0)) < 4.5 * error).all()
    angles_of_the_mean_pose(results)


@known("angles.mot", "*_*", "girdle_rz", source="the mean state of `state.csv`, by SciPy's rotations; `pelvis_tx` … the middle of the hips in `markers.trc`")
def angles_of_the_mean_pose(results):
    means, names = mean_state(results)
    table = results.tables["angles.mot"]
    assert len(table) == results.frames
    expected = joint_angles(names, means)
    for name in table.columns[1:]:
        if name.startswith("pelvis_t") and name[-1] in "xyz" and len(name) == 9:
            value = results.tables["markers.trc"][f"MidHip.{name[-1].upper()}"]
            assert np.allclose(table[name], value, atol=1e-6), name
        else:
            assert np.allclose(table[name], expected[name], atol=1e-6), name
    assert set(expected) <= set(table.columns)


@known("angles.mot", "time", source="the number of the frame over the frame rate")
@known("markers.trc", "Time", source="the number of the frame over the frame rate")
def times_are_numbers_over_the_rate(results):
    for file, column in (("angles.mot", "time"), ("markers.trc", "Time")):
        assert np.allclose(results.tables[file][column], np.array(results.numbers) / results.fps, atol=1e-9)


@known("angles.csv", "name", "mean_deg", "q05_deg", "q95_deg", source=DRAWS)
def angles_follow_from_draws(results):
    draws, names = state_draws(results)
    expected = joint_angles(names, draws)
    table = results.tables["angles.csv"]
    found = list(table.name[: len(table) // results.frames])
    assert list(table.name) == found * results.frames
    assert sorted(found) == sorted(expected)
    assert found == [name for name in results.tables["angles.mot"].columns[1:] if name in expected]
    series = np.stack([expected[name] for name in found], -1)
    middle = np.degrees(np.angle(np.exp(1j * np.radians(series)).mean(0)))
    series = middle + (series - middle + 180) % 360 - 180
    for what, value in (("mean", series.mean(0)), ("q05", quantile(series, 0.05)), ("q95", quantile(series, 0.95))):
        assert np.allclose(results.of("angles.csv", f"{what}_deg", "name")[0], value, atol=DEGREES), what


@known("angles.csv", "rate_*_deg_s", source="differences of the smoothed draws, which are trajectories", runs=("smoothed",))
def rates_are_differences_of_trajectories(results):
    """The window is from one frame before to one frame after (1/30 s at 30 frames a second), and what is left of it at the ends."""
    draws, names = state_draws(results)
    _, found = results.of("angles.csv", "mean_deg", "name")
    expected = joint_angles(names, draws)
    series = np.unwrap(np.stack([expected[name] for name in found], -1), period=360, axis=1)
    around = max(1, round(results.fps / 30))
    last = results.frames - 1
    for frame in range(results.frames):
        first, end = max(0, frame - around), min(last, frame + around)
        rates = (series[:, end] - series[:, first]) * results.fps / (end - first)
        for what, value in (("mean", rates.mean(0)), ("q05", quantile(rates, 0.05)), ("q95", quantile(rates, 0.95))):
            row = results.of("angles.csv", f"rate_{what}_deg_s", "name")[0][frame]
            assert np.allclose(row, value, atol=0.01), (what, frame)
