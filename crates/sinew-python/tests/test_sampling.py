"""Samplers on Gaussians that are known, verbs on weights that are known."""

import numpy as np
import pytest

import sinew

MEAN = np.array([1.0, -2.0, 0.5])
COVARIANCE = np.array([[1.0, 0.8, 0.0], [0.8, 2.0, -0.3], [0.0, -0.3, 0.25]])
PRECISION = np.linalg.inv(COVARIANCE)


def gaussian(states):
    gradient = -(states - MEAN) @ PRECISION
    return 0.5 * ((states - MEAN) * gradient).sum(axis=1), gradient


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("sampler", [sinew.samplers.nuts, sinew.samplers.hmc])
def test_draws_are_of_the_gaussian(sampler):
    """Mean and covariance within 5 standard errors of the effective number of draws."""
    found = sampler(gaussian, np.zeros((8, 3)), draws=800, seed=5)
    assert found.draws.shape == (8, 800, 3)
    np.testing.assert_allclose(found.lp.ravel(), gaussian(found.draws.reshape(-1, 3))[0], atol=1e-12)
    draws, sd = found.draws.reshape(-1, 3), np.sqrt(np.diag(COVARIANCE))
    for j in range(3):
        series = found.draws[:, :, j]
        assert sinew.samplers.r_hat(series) < 1.05
        ess = sinew.samplers.bulk_ess(series)
        assert ess > 200
        assert abs(series.mean() - MEAN[j]) < 5 * sd[j] / np.sqrt(ess)
        ess_of_squares = sinew.samplers.bulk_ess((series - MEAN[j]) ** 2)
        assert abs(series.var() / COVARIANCE[j, j] - 1) < 5 * np.sqrt(2 / ess_of_squares)
    assert abs(np.corrcoef(draws.T)[0, 1] - 0.8 / np.sqrt(2)) < 0.1
    assert not found.diverging.any()
    assert (found.leapfrog_steps > 0).all() and found.depth.any() == (sampler is sinew.samplers.nuts)
    assert all("effective draws" in warning for warning in found.warnings) and "bulk ESS" in str(found) and str(found) == found.summary


def test_a_run_that_fails_warns():
    """Half of the states cannot be, and no gradient says so."""
    def walled(states):
        values, gradients = gaussian(states)
        return np.where(np.sin(40 * states[:, 0]) > 0, values, -np.inf), gradients

    with pytest.warns(RuntimeWarning) as heard:
        found = sinew.samplers.nuts(walled, np.full((4, 3), 0.04), draws=200, warm_up=170)
    assert found.warnings == [str(of.message) for of in heard if of.category is RuntimeWarning]
    assert all(of.filename == __file__ for of in heard)
    for words in ("trajectories diverged", "R-hat of", "effective draws"):
        assert any(words in warning for warning in found.warnings), words


def test_trees_and_energies_that_fail_warn():
    """Trees of depth 1 on a Gaussian in twenty dimensions; the energies of a funnel, whose E-BFMI is low."""
    with pytest.warns(RuntimeWarning, match="trees reached the greatest depth .* raise `max_depth`"):
        normal = lambda x: (-0.5 * (x**2).sum(1), -x)  # noqa: E731
        sinew.samplers.nuts(normal, np.zeros((4, 20)), draws=100, warm_up=170, max_depth=1)

    def funnel(x):
        v, rest = x[:, :1], x[:, 1:]
        square = (rest**2).sum(1, keepdims=True) * np.exp(-v)
        value = -v[:, 0] ** 2 / 18 - 0.5 * square[:, 0] - 0.5 * rest.shape[1] * v[:, 0]
        return value, np.hstack([-v / 9 + 0.5 * square - 0.5 * rest.shape[1], -rest * np.exp(-v)])

    with pytest.warns(RuntimeWarning, match=r"E-BFMI is 0\.\d\d in one chain, below 0\.3"):
        sinew.samplers.nuts(funnel, np.ones((4, 10)), draws=200, warm_up=170, max_depth=5, seed=1)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_chains_go_to_arviz():
    found = sinew.samplers.nuts(gaussian, np.zeros((3, 3)), draws=50, warm_up=170)
    tree = found.to_arviz()
    assert dict(tree["posterior"].sizes) == {"chain": 3, "draw": 50, "coordinate": 3}
    np.testing.assert_array_equal(tree["posterior"]["x"].values, found.draws)
    stats = tree["sample_stats"]
    for name, values in {"diverging": found.diverging, "energy": found.energy, "lp": found.lp}.items():
        assert stats[name].dims == ("chain", "draw")
        np.testing.assert_array_equal(stats[name].values, values)
    named = found.to_arviz(["a", "b", "c"])["posterior"]
    np.testing.assert_array_equal(named["b"].values, found.draws[:, :, 1])
    arviz = pytest.importorskip("arviz", reason="no arviz")
    r_hat = float(arviz.rhat(found.to_arviz(["a", "b", "c"]))["b"])
    assert r_hat == pytest.approx(sinew.samplers.r_hat(found.draws[:, :, 1]), abs=1e-9)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_the_same_seed_gives_the_same_draws():
    draws = [sinew.samplers.nuts(gaussian, np.zeros((3, 3)), draws=50, warm_up=170, seed=s).draws for s in (1, 1, 2)]
    np.testing.assert_array_equal(draws[0], draws[1])
    assert (draws[0] != draws[2]).any()


def test_what_a_density_raises_comes_back():
    def broken(states):
        raise LookupError("no such state")

    with pytest.raises(LookupError, match="no such state"):
        sinew.samplers.nuts(broken, np.zeros((2, 3)))
    with pytest.raises(sinew.InputError, match=r"returned arrays of the shapes \(8,\) and \(8,\); expected"):
        sinew.samplers.nuts(lambda states: (states[:, 0], states[:, 0]), np.zeros((2, 3)))
    with pytest.raises(sinew.InputError, match="chain 0 starts at a log density of -inf"):
        sinew.samplers.nuts(lambda states: (np.full(len(states), -np.inf), states), np.zeros((2, 3)))
    with pytest.raises(sinew.UsageError, match="`warm_up` is 3; at least 1 and 170"):
        sinew.samplers.nuts(gaussian, np.zeros((2, 3)), warm_up=3)
    with pytest.raises(sinew.InputError, match=r"`starts` has the shape \(3,\); expected \(chains, dim\)"):
        sinew.samplers.nuts(gaussian, np.zeros(3))


def test_weights_are_exponentials_that_sum_to_one():
    log_weights = np.array([-1000.0, -1001.0, -np.inf])
    weights, log_sum = sinew.particles.normalise(log_weights)
    expected = np.array([1, np.exp(-1), 0]) / (1 + np.exp(-1))
    np.testing.assert_allclose(weights, expected, rtol=1e-14)
    assert log_sum == pytest.approx(-1000 + np.log1p(np.exp(-1)), rel=1e-14)
    assert sinew.particles.effective_number(7 * weights) == pytest.approx(1 / (expected**2).sum())
    with pytest.raises(sinew.InputError, match="all 2 weights are zero"):
        sinew.particles.normalise([-np.inf, -np.inf])


@pytest.mark.parametrize("scheme", ["systematic", "stratified", "residual", "multinomial"])
def test_resampling_keeps_the_mean_counts(scheme):
    """Mean counts over 2000 seeds within 5 standard errors of multinomial ones."""
    weights = np.array([0.5, 0.3, 0.15, 0.05, 0.0])
    ancestors = [sinew.particles.resample(weights, 10, scheme=scheme, seed=seed) for seed in range(2000)]
    counts = np.mean([np.bincount(of, minlength=5) for of in ancestors], axis=0)
    error = np.sqrt(10 * weights * (1 - weights) / 2000)
    assert (abs(counts - 10 * weights) <= 5 * error).all()
    assert all((np.diff(of) >= 0).all() for of in ancestors)


def test_an_exponent_keeps_the_survivors_that_it_promises():
    values = np.random.default_rng(1).normal(0, 30, 500)
    exponent = sinew.particles.tempering_exponent(values, 0.4)
    weights, _ = sinew.particles.normalise(exponent * values)
    assert sinew.particles.effective_number(weights) == pytest.approx(200, rel=1e-6)
    assert sinew.particles.tempering_exponent(np.zeros(5)) == 1.0


def test_wrong_weights_are_named():
    with pytest.raises(sinew.UsageError, match="no memory for an array"):
        sinew.particles.resample([1.0], 2**60)
    with pytest.raises(sinew.UsageError, match="no memory for an array"):
        sinew.samplers.nuts(gaussian, np.zeros((2, 3)), draws=2**60)
    with pytest.raises(sinew.InputError, match="`weights`: number 1 is -1; none may be negative"):
        sinew.particles.resample([1, -1])
    with pytest.raises(sinew.InputError, match="their sum is 0; it must be positive"):
        sinew.particles.effective_number([0, 0])
    with pytest.raises(sinew.InputError, match=r"known: .*; did you mean `systematic`\?"):
        sinew.particles.resample([1], scheme="sistematic")
