//! The single-frame study: how the variance of the estimated mean falls with computation, particle filter against hybrid Monte Carlo.
//!
//! For each of six frames, three parts of the body and each setting of Table 1, fifty independent runs estimate the posterior mean of one fixed observation. A cell
//! holds the means of its runs; everything else is computed from them and the reference ([`super::claims`]).

use super::chains::{self, Step, Variant};
use super::likelihood_weighting::{weigh, weigh_parts};
use super::problem::Problem;
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::core::diagnostics::{effective_sample_size, split_r_hat};
use sinew::core::random::Stage;
use std::time::Instant;

/// A setting of Table 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Setting {
    /// Particles N.
    Particles(usize),
    /// Updates R of each chain.
    Updates(Variant, usize),
}

impl Setting {
    pub(super) fn name(&self) -> String {
        match self {
            Self::Particles(count) => format!("particle filter, N = {count}"),
            Self::Updates(variant, updates) => format!("{}, R = {updates}", variant.name()),
        }
    }
}

/// Runs a cell.
pub(super) fn cell(
    problem: &Problem,
    setting: Setting,
    step: Option<&Step>,
    runs: usize,
    stage: &Stage,
) -> Outcome<Value> {
    let (mut means, mut effective, mut acceptance) = (vec![], vec![], vec![]);
    let clock = Instant::now();
    for run in 0..runs {
        let stage = stage.round(run);
        match setting {
            Setting::Particles(count) => {
                let weighted = weigh(&problem.likelihood, &problem.walk, &problem.previous, (count, false), &stage);
                means.push(weighted.mean(&problem.previous));
                effective.push(weighted.effective());
            }
            Setting::Updates(variant, updates) => {
                let step = step.ok_or("the step was not tuned")?;
                let draws = chains::run(problem, variant, step, problem.model.chains, updates, stage)?;
                acceptance.push(draws.acceptance);
                means.push(chains::mean(&draws));
            }
        }
    }
    let seconds = clock.elapsed().as_secs_f64() / runs as f64;
    let (likelihoods, gradients) = match (setting, step) {
        (Setting::Updates(_, updates), Some(step)) => chains::cost(step, problem.model.chains, updates),
        (Setting::Particles(count), _) => (count, 0),
        _ => (0, 0),
    };
    Ok(json!({
        "seconds": seconds,
        "likelihoods": likelihoods,
        "gradients": gradients,
        "means": means,
        "effective": effective,
        "acceptance": acceptance,
    }))
}

/// Degrees of freedom up to which weighted draws of the prior are a reference; beyond, long chains are.
pub(super) const WEIGHABLE: usize = 10;

/// Posterior mean and covariance of a frame, and the Monte Carlo error of the mean.
pub(super) fn reference(
    problem: &Problem,
    particles: usize,
    parts: usize,
    updates: usize,
    step: &Step,
    stage: Stage,
) -> Outcome<Value> {
    let d = problem.model.dim;
    if d <= WEIGHABLE {
        let weighted = weigh_parts(&problem.likelihood, &problem.walk, &problem.previous, (particles, parts), &stage);
        let covariance = weighted.covariance();
        let effective = weighted.effective();
        let error: Vec<f64> = (0..d).map(|j| (covariance[j * d + j] / effective).sqrt()).collect();
        return Ok(json!({ "mean": weighted.mean(&problem.previous), "covariance": covariance, "error": error }));
    }
    reference_by_chains(problem, updates, step, stage)
}

/// The same from 64 long chains, with the largest split R̂ of their variables.
pub(super) fn reference_by_chains(problem: &Problem, updates: usize, step: &Step, stage: Stage) -> Outcome<Value> {
    let d = problem.model.dim;
    let draws = chains::run(problem, Variant::Dense, step, 64, updates, stage)?;
    let mean = chains::mean(&draws);
    let series: Vec<Vec<Vec<f64>>> = (0..d).map(|j| draws.series(j)).collect();
    let count = draws.stats.len() as f64;
    let mut covariance = vec![0.0; d * d];
    for i in 0..d {
        for j in 0..=i {
            let pairs = series[i].iter().flatten().zip(series[j].iter().flatten());
            let value = pairs.map(|(a, b)| (a - mean[i]) * (b - mean[j])).sum::<f64>() / count;
            (covariance[i * d + j], covariance[j * d + i]) = (value, value);
        }
    }
    let error: Vec<f64> = (0..d).map(|j| (covariance[j * d + j] / effective_sample_size(&series[j])).sqrt()).collect();
    let r_hat = series.iter().map(|series| split_r_hat(series)).fold(f64::NAN, f64::max);
    Ok(json!({ "mean": mean, "covariance": covariance, "error": error, "r_hat": r_hat }))
}
