"""Methods that weigh particles, all of which are among the draws: numbers follow from particles and weights, to the precision in which they are stored."""

import numpy as np
from angles import state_draws
from ledger import known
from points import MOMENTS, OF_AN_SD, columns, names_are
from weighted import DEGREES, METRES, named_angles, named_state

SOURCE = "the particles among the draws of `posterior.zarr`, each drawn as often as its weight says, by NumPy"
RUNS = ("bootstrap", "searched")
# Of `hppf`: steps of the random walk within which a particle is like the best one.
LIKE = 3


def particles(results):
    """Place of each particle among the draws, and its weight, frames × particles. Draws are taken in the order of the particles, systematically: so many for a weight, or one more or less."""
    weights = np.exp(results.statistics["log_weight"][0]).T
    placed = results.draws["marker_position"][0]
    begins = np.ones(placed.shape[:2], bool)
    begins[1:] = (placed[1:] != placed[:-1]).any((2, 3))
    assert (begins.sum(0) == weights.shape[1]).all(), "a particle was not drawn"
    places = np.stack([np.flatnonzero(frame) for frame in begins.T])
    often = np.diff(places, append=len(placed))
    assert (abs(often - len(placed) * weights) < 1).all()
    return places, weights


def taken(places, draws):
    """The particles among draws × frames × …, as particles × frames × …."""
    return np.stack([draws[places[frame], frame] for frame in range(len(places))], 1).astype(float)


def mean(values, weights):
    return np.einsum("fp,pfn->fn", weights, values)


def quantile(values, weights, p):
    """The least value below or at which the share p of the weight lies."""
    order = np.argsort(values, 0)
    below = np.cumsum(np.take_along_axis(np.broadcast_to(weights.T[..., None], values.shape), order, 0), 0)
    return np.take_along_axis(np.take_along_axis(values, order, 0), (below < p).sum(0)[None], 0)[0]


@known("joints.csv", "joint", *MOMENTS, source=SOURCE, runs=RUNS)
def joints_follow_from_particles(results):
    names_are(results, "joints.csv", "joint", "marker")
    places, weights = particles(results)
    values = taken(places, results.draws["marker_position"][0])
    values = values.reshape(*values.shape[:2], -1)
    middle = mean(values, weights)
    sd = np.sqrt(mean((values - middle) ** 2, weights))
    expected = {"mean": middle, "sd": sd, "q05": quantile(values, weights, 0.05), "q95": quantile(values, weights, 0.95)}
    for what, value in expected.items():
        found = columns(results, "joints.csv", "joint", what).reshape(value.shape)
        assert (abs(found - value) < OF_AN_SD * sd + METRES).all(), what


@known("state.csv", "name", "unit", "q05", "q95", source=SOURCE, runs=RUNS)
def state_follows_from_particles(results):
    places, weights = particles(results)
    values = taken(places, named_state(results))
    for what, p in (("q05", 0.05), ("q95", 0.95)):
        assert np.allclose(results.of("state.csv", what, "name")[0], quantile(values, weights, p), atol=DEGREES), what


@known("state.csv", "mean", source=SOURCE, runs=("bootstrap",))
def the_mean_state_is_that_of_the_particles(results):
    places, weights = particles(results)
    assert np.allclose(results.of("state.csv", "mean", "name")[0], mean(taken(places, named_state(results)), weights), atol=DEGREES)


@known("state.csv", "mean", source="the mean of the particles within three steps of the walk (`motion_sd` of `setup.toml`) of the one of most weight", runs=("searched",))
def the_mean_state_is_that_of_particles_like_the_best(results):
    places, weights = particles(results)
    names = results.of("state.csv", "mean", "name")[1]
    values = taken(places, named_state(results))
    is_angle = np.array([".t" not in name for name in names])
    steps = np.array(results.setup["motion_sd"]) / np.sqrt(results.fps)
    away = values - values[weights.argmax(1), np.arange(results.frames)]
    away = np.where(is_angle, (away + 180) % 360 - 180, away)
    is_like = (abs(away) <= LIKE * np.where(is_angle, np.degrees(steps), steps)).all(-1).T
    best = values[weights.argmax(1), np.arange(results.frames)]
    expected = best + mean(away, weights * is_like) / (weights * is_like).sum(1, keepdims=True)
    assert np.allclose(results.of("state.csv", "mean", "name")[0], expected, atol=DEGREES)


@known("angles.csv", "name", "mean_deg", "q05_deg", "q95_deg", source=SOURCE + " and SciPy's rotations; angles of draws are those nearest to the mean pose's of `angles.mot`", runs=RUNS)
def angles_follow_from_particles(results):
    places, weights = particles(results)
    draws, names = state_draws(results)
    values, found = named_angles(results, taken(places, draws), names)
    of_the_pose = results.tables["angles.mot"][found].to_numpy()
    values = of_the_pose + (values - of_the_pose + 180) % 360 - 180
    expected = {"mean": mean(values, weights), "q05": quantile(values, weights, 0.05), "q95": quantile(values, weights, 0.95)}
    for what, value in expected.items():
        assert np.allclose(results.of("angles.csv", f"{what}_deg", "name")[0], value, atol=DEGREES), what


@known("frames.csv", "ess", source="1 / Σ w² of the weights in `posterior.zarr`", runs=("weighted", *RUNS))
def ess_is_that_of_the_weights(results):
    weights = np.exp(results.statistics["log_weight"][0])
    assert np.allclose(results.tables["frames.csv"].ess, 1 / (weights**2).sum(0), rtol=1e-9)
