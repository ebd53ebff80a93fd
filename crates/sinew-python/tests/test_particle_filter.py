"""The particle filter against the Kalman filter and smoother, which are exact for linear Gaussian models."""

import numpy as np
import pytest

import sinew

TURN, STEP, VIEW, ERROR = np.array([[0.9, 0.3], [-0.2, 0.8]]), np.diag([0.3, 0.2]), np.array([1.0, 0.5]), 0.7
FRAMES, PARTICLES = 12, 20_000


def exact(observations):
    """Log evidences, means and covariances of the filter, and means and variances of the smoother."""
    mean, cov, kept, logs = np.zeros(2), np.eye(2), [], []
    for frame, y in enumerate(observations):
        if frame > 0:
            mean, cov = TURN @ mean, TURN @ cov @ TURN.T + STEP @ STEP
        ahead = mean, cov
        spread = VIEW @ cov @ VIEW + ERROR**2
        logs.append(-0.5 * (np.log(2 * np.pi * spread) + (y - VIEW @ mean) ** 2 / spread))
        gain = cov @ VIEW / spread
        mean, cov = mean + gain * (y - VIEW @ mean), cov - np.outer(gain, VIEW @ cov)
        kept.append((*ahead, mean, cov))
    smooth = [kept[-1][2:]]
    for before, after in zip(kept[-2::-1], kept[:0:-1], strict=True):
        back = before[3] @ TURN.T @ np.linalg.inv(after[1])
        mean, cov = smooth[0]
        smooth.insert(0, (before[2] + back @ (mean - after[0]), before[3] + back @ (cov - after[1]) @ back.T))
    means, covs = (np.array(of) for of in zip(*[of[2:] for of in kept], strict=True))
    return np.array(logs), means, covs, *(np.array(of) for of in zip(*smooth, strict=True))


@pytest.fixture(scope="module")
def observations():
    """Of the model itself."""
    rng, state, seen = np.random.default_rng(3), None, []
    for _ in range(FRAMES):
        state = rng.normal(size=2) if state is None else TURN @ state + STEP @ rng.normal(size=2)
        seen.append(VIEW @ state + ERROR * rng.normal())
    return np.array(seen)


def model():
    def log_likelihood(y, states, frame):
        return -0.5 * (((y - states @ VIEW) / ERROR) ** 2 + np.log(2 * np.pi * ERROR**2))

    return sinew.particles.ParticleFilter(
        lambda rng, n: rng.normal(size=(n, 2)),
        lambda rng, states, frame: states @ TURN.T + rng.normal(size=states.shape) @ STEP,
        log_likelihood,
    )


@pytest.mark.parametrize("scheme", ["systematic", "multinomial"])
def test_moments_and_evidence_are_the_kalman_filters(observations, scheme):
    """Over eight seeds: their mean within 5 standard errors, and each of them within 0.1."""
    logs, means, covs, smooth, spread = exact(observations)
    runs = [model().run(observations, particles=PARTICLES, scheme=scheme, seed=seed) for seed in range(8)]

    def check(values, due):
        values = np.array(values)
        error = np.maximum(values.std(axis=0, ddof=1) / np.sqrt(len(values)), 1e-4)
        assert (abs(values.mean(axis=0) - due) < 5 * error).all()
        np.testing.assert_allclose(values, np.broadcast_to(due, values.shape), atol=0.1)

    check([run.log_evidences for run in runs], logs)
    check([run.log_evidence for run in runs], logs.sum())
    check([run.means for run in runs], means)
    check([run.variances for run in runs], np.diagonal(covs, axis1=1, axis2=2))
    paths = [run.trajectories(5000, seed=1) for run in runs]
    assert paths[0].shape == (5000, FRAMES, 2)
    check([of.mean(axis=0) for of in paths], smooth)
    check([of.var(axis=0) for of in paths], np.diagonal(spread, axis1=1, axis2=2))


def test_particles_are_weighted_and_have_ancestors(observations):
    run = model().run(observations, particles=500, seed=2)
    np.testing.assert_allclose(run.weights.sum(axis=1), 1)
    np.testing.assert_allclose(run.ess, 1 / (run.weights**2).sum(axis=1))
    np.testing.assert_allclose(run.means, np.einsum("tn,tnd->td", run.weights, run.states))
    resampled = (run.ancestors != np.arange(500)).any(axis=1)
    np.testing.assert_array_equal(resampled[1:], run.ess[:-1] <= 250)
    assert resampled.any() and not resampled.all()
    never = model().run(observations, particles=500, resample_below=0, seed=2)
    assert (never.ancestors == np.arange(500)).all() and never.ess[-1] < run.ess[-1]
    np.testing.assert_array_equal(model().run(observations, particles=500, seed=2).states, run.states)


def test_wrong_functions_are_named(observations):
    def filtered(**change):
        of = model()
        functions = {"initial": of._initial, "transition": of._transition, "log_likelihood": of._log_likelihood}
        return sinew.particles.ParticleFilter(**functions | change).run(observations, particles=10)

    with pytest.raises(sinew.InputError, match=r"`initial` returned an array of the shape \(10,\); expected \(10, dim\)"):
        filtered(initial=lambda rng, n: np.zeros(n))
    with pytest.raises(sinew.InputError, match=r"`log_likelihood` returned .* \(10, 2\); expected \(10,\)"):
        filtered(log_likelihood=lambda y, states, frame: states)
    with pytest.raises(sinew.InputError, match="frame 3: all 10 weights are zero"):
        filtered(log_likelihood=lambda y, states, frame: np.full(10, -np.inf if frame == 3 else 0.0))
    with pytest.raises(sinew.InputError, match="`observations` is empty"):
        model().run([])
