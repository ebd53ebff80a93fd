//! Verbs of particle filters on log weights, and diagnostics of chains.

use crate::arrays::{Numbers, affordable, array, numbers};
use crate::failure::Failure;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use sinew::core::diagnostics;
use sinew::core::random::Stage;
use sinew::formats::nearest::nearest;
use sinew::samplers::resample::Scheme;
use sinew::samplers::{temperature, weights};

const SCHEMES: [(&str, Scheme); 4] = [
    ("multinomial", Scheme::Multinomial),
    ("residual", Scheme::Residual),
    ("stratified", Scheme::Stratified),
    ("systematic", Scheme::Systematic),
];

fn vector<'a>(given: &'a Numbers<'_>) -> Result<&'a [f64], Failure> {
    given.exactly(&[("particles", None)])?;
    given.values()
}

/// Normalised weights of log weights.
///
/// Parameters
/// ----------
/// log_weights
///     (particles,), logarithms that need not be normalised; -inf is a weight of zero.
///
/// Returns
/// -------
/// Weights (particles,) that sum to 1, and the logarithm of the sum of the exponentials.
#[pyfunction]
pub(crate) fn normalise<'py>(
    py: Python<'py>,
    log_weights: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, f64)> {
    let given = numbers("log_weights", log_weights)?;
    let mut normalised = Vec::new();
    let log_sum = weights::normalise(vector(&given)?, &mut normalised).map_err(Failure::from)?;
    Ok((array(py, [normalised.len()], normalised)?, log_sum))
}

/// Effective number 1 / sum(W^2) of weights (particles,), which need not be normalised.
#[pyfunction]
pub(crate) fn effective_number(weights: &Bound<'_, PyAny>) -> PyResult<f64> {
    let given = numbers("weights", weights)?;
    let (weights, sum) = proper(&given)?;
    Ok(weights::effective_number(&weights.iter().map(|w| w / sum).collect::<Vec<_>>()))
}

/// Weights that can be resampled by, and their sum.
fn proper<'a>(given: &'a Numbers<'_>) -> Result<(&'a [f64], f64), Failure> {
    let weights = vector(given)?;
    let sum = weights.iter().sum::<f64>();
    match weights.iter().position(|w| !(*w >= 0.0 && w.is_finite())) {
        Some(at) => Err(Failure::argument(format!("`weights`: number {at} is {}; none may be negative", weights[at]))),
        None if sum > 0.0 && sum.is_finite() => Ok((weights, sum)),
        None => Err(Failure::argument(format!("`weights`: their sum is {sum}; it must be positive"))),
    }
}

/// Ancestors of a new population.
///
/// Parameters
/// ----------
/// weights
///     (particles,), not negative; they need not be normalised.
/// n
///     Size of the new population; as many as there are weights by default.
/// scheme
///     `systematic`, `stratified`, `residual` or `multinomial`. All are unbiased.
/// seed
///     The same seed gives the same ancestors.
///
/// Returns
/// -------
/// (n,) indices, rising.
#[pyfunction]
#[pyo3(signature = (weights, n = None, *, scheme = "systematic", seed = 0))]
pub(crate) fn resample<'py>(
    py: Python<'py>,
    weights: &Bound<'py, PyAny>,
    n: Option<usize>,
    scheme: &str,
    seed: u64,
) -> PyResult<Bound<'py, PyArrayDyn<i64>>> {
    let given = numbers("weights", weights)?;
    let (weights, _) = proper(&given)?;
    let Some((_, chosen)) = SCHEMES.iter().find(|(name, _)| *name == scheme) else {
        let names = SCHEMES.map(|(name, _)| name);
        let meant = nearest(scheme, names).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default();
        let what = format!("`scheme` is `{scheme}`; known: {}{meant}", names.join(", "));
        return Err(Failure::argument(what).into());
    };
    let n = n.unwrap_or(weights.len());
    affordable(&[n, 2])?;
    let ancestors = chosen.ancestors(weights, n, &mut Stage::new(seed, "resample").whole());
    array(py, [n], ancestors.into_iter().map(|index| index as i64).collect())
}

/// The largest exponent of a likelihood at which enough states survive.
///
/// Parameters
/// ----------
/// log_likelihoods
///     (particles,).
/// survival
///     Part of the states that must stay effective, between 0 and 1.
/// most
///     Greatest exponent; for tempering what is missing from 1.
///
/// Returns
/// -------
/// The exponent: weights exp(exponent * log_likelihoods) have an effective number of survival times that of the states reached.
#[pyfunction]
#[pyo3(signature = (log_likelihoods, survival = 0.5, *, most = 1.0))]
pub(crate) fn tempering_exponent(log_likelihoods: &Bound<'_, PyAny>, survival: f64, most: f64) -> PyResult<f64> {
    let given = numbers("log_likelihoods", log_likelihoods)?;
    Ok(temperature::exponent(vector(&given)?, survival, most).map_err(Failure::from)?)
}

fn chains(draws: &Bound<'_, PyAny>, diagnostic: fn(&[&[f64]]) -> f64) -> PyResult<f64> {
    let given = numbers("draws", draws)?;
    let shape = given.exactly(&[("chains", None), ("draws", None)])?;
    let each = shape[1];
    if given.values()?.is_empty() {
        return Ok(f64::NAN);
    }
    Ok(diagnostic(&given.values()?.chunks_exact(each).collect::<Vec<_>>()))
}

/// Rank-normalised split R-hat of draws (chains, draws) of one quantity (Vehtari et al. 2021).
#[pyfunction]
pub(crate) fn r_hat(draws: &Bound<'_, PyAny>) -> PyResult<f64> {
    chains(draws, |chains| diagnostics::rank_r_hat(chains))
}

/// Effective number of draws (chains, draws) for the bulk of one quantity (Vehtari et al. 2021).
#[pyfunction]
pub(crate) fn bulk_ess(draws: &Bound<'_, PyAny>) -> PyResult<f64> {
    chains(draws, |chains| diagnostics::bulk_ess(chains))
}

/// Effective number of draws (chains, draws) for the tails of one quantity (Vehtari et al. 2021).
#[pyfunction]
pub(crate) fn tail_ess(draws: &Bound<'_, PyAny>) -> PyResult<f64> {
    chains(draws, |chains| diagnostics::tail_ess(chains))
}
