//! Three posteriors of posteriordb (BSD-3-Clause; `posteriordb/LICENCE-posteriordb.md` of the data folder) as unconstrained densities with gradients, and what a sampler makes of them.
//!
//! Each file states its density; here it is written by hand with its gradient and checked against the stored points before anything is sampled. The warm-up knows nothing of the posterior: three rounds of no-U-turn chains from
//! scattered starts, each with the metric that the round before has learned.

use crate::finding::Finding;
use crate::linear_series::rows;
use crate::stored::{number, numbers, stored};
use serde_json::Value;
use sinew::core::convergence::{bulk_ess, rank_r_hat};
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::diagnostics::{effective_sample_size, split_r_hat};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::samplers::chains::{Draws, Schedule, draw};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::metric::Metric;
use sinew::samplers::nuts::{self, Nuts};
use sinew::samplers::tuning::{self, Trial};
use sinew::samplers::{Error, learned};

/// Which posterior, with its data.
#[derive(Clone, Debug)]
enum Model {
    /// Observations with their standard deviations; u = (θ̃_1 … θ̃_8, μ, ln τ).
    EightSchools { y: Vec<f64>, sigma: Vec<f64> },
    /// Observations and regressors; u = (β, ln σ).
    Regression { y: Vec<f64>, x: Vec<Vec<f64>> },
    /// Observations and their places; u = (ln ρ, ln α, ln σ).
    GaussianProcess { y: Vec<f64>, x: Vec<f64> },
}

/// A posterior with its reference.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// Its file's name.
    pub name: String,
    /// Divergent trajectories that are forgiven.
    pub divergences: usize,
    /// The whole file.
    pub stored: Value,
    model: Model,
    dim: usize,
}

/// The three posteriors; none, with a note, where the data folder is missing.
#[must_use]
pub fn all() -> Vec<Posterior> {
    let names = [("eight_schools-eight_schools_noncentered", 5), ("sblrc-blr", 0), ("gp_pois_regr-gp_regr", 0)];
    names.into_iter().filter_map(|(name, divergences)| Posterior::stored(name, divergences)).collect()
}

impl Posterior {
    fn stored(name: &str, divergences: usize) -> Option<Self> {
        let v = stored(&format!("posteriordb/{name}.json"))?;
        let data = &v["data"];
        let y = numbers(&data["y"]);
        let model = match name {
            "sblrc-blr" => Model::Regression { y, x: rows(&data["X"]) },
            "gp_pois_regr-gp_regr" => Model::GaussianProcess { y, x: numbers(&data["x"]) },
            _ => Model::EightSchools { y, sigma: numbers(&data["sigma"]) },
        };
        let dim = v["unconstrained_names"].as_array().expect("array").len();
        Some(Self { name: name.into(), divergences, stored: v, model, dim })
    }

    /// The quantities of the reference at an unconstrained state, in the order of [`Posterior::names`].
    #[must_use]
    pub fn constrained(&self, u: &[f64]) -> Vec<f64> {
        match &self.model {
            Model::EightSchools { .. } => {
                let (mu, tau) = (u[8], u[9].exp());
                (0..8).map(|j| mu + tau * u[j]).chain([mu, tau]).collect()
            }
            Model::Regression { .. } => u[..5].iter().copied().chain([u[5].exp()]).collect(),
            Model::GaussianProcess { .. } => u.iter().map(|u| u.exp()).collect(),
        }
    }

    /// Names of the reference's quantities.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match self.model {
            Model::EightSchools { .. } => {
                (1..=8).map(|j| format!("theta[{j}]")).chain(["mu".into(), "tau".into()]).collect()
            }
            Model::Regression { .. } => (1..=5).map(|j| format!("beta[{j}]")).chain(["sigma".into()]).collect(),
            Model::GaussianProcess { .. } => ["rho", "alpha", "sigma"].map(String::from).into(),
        }
    }
}

impl LogDensity for Posterior {
    fn dim(&self) -> usize {
        self.dim
    }
    fn log_density(&self, u: &[f64]) -> f64 {
        self.log_density_grad(u, &mut vec![0.0; u.len()])
    }
}

impl GradLogDensity for Posterior {
    fn log_density_grad(&self, u: &[f64], grad: &mut [f64]) -> f64 {
        let value = match &self.model {
            Model::EightSchools { y, sigma } => eight_schools(y, sigma, u, grad),
            Model::Regression { y, x } => regression(y, x, u, grad),
            Model::GaussianProcess { y, x } => gaussian_process(y, x, u, grad),
        };
        if value.is_finite() { value } else { f64::NEG_INFINITY }
    }
}

/// −½ Σ t_j² − ½ Σ ((y_j − μ − τ t_j) / s_j)² − μ² / 50 − ln(1 + τ² / 25) + ln τ.
fn eight_schools(y: &[f64], sigma: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let (mu, tau) = (u[8], u[9].exp());
    let mut value = -mu * mu / 50.0 - (tau * tau / 25.0).ln_1p() + u[9];
    (grad[8], grad[9]) = (-mu / 25.0, 1.0 - 2.0 * tau * tau / (25.0 + tau * tau));
    for j in 0..8 {
        let error = (y[j] - mu - tau * u[j]) / sigma[j];
        value -= 0.5 * (u[j] * u[j] + error * error);
        let pull = error / sigma[j];
        grad[j] = tau * pull - u[j];
        grad[8] += pull;
        grad[9] += tau * u[j] * pull;
    }
    value
}

/// −β·β / 200 − σ² / 200 − |y − X β|² / (2 σ²) − N ln σ + ln σ.
fn regression(y: &[f64], x: &[Vec<f64>], u: &[f64], grad: &mut [f64]) -> f64 {
    let (beta, log_sigma) = (&u[..5], u[5]);
    let variance = (2.0 * log_sigma).exp();
    let (mut value, mut square) = (0.0, 0.0);
    for (g, b) in grad.iter_mut().zip(beta) {
        *g = -b / 100.0;
        value -= b * b / 200.0;
    }
    for (y, row) in y.iter().zip(x) {
        let error = y - row.iter().zip(beta).map(|(x, b)| x * b).sum::<f64>();
        square += error * error;
        for (g, x) in grad.iter_mut().zip(row) {
            *g += error * x / variance;
        }
    }
    let n = y.len() as f64;
    grad[5] = -variance / 100.0 + square / variance - n + 1.0;
    value - variance / 200.0 - 0.5 * square / variance + (1.0 - n) * log_sigma
}

/// −½ yᵀ K⁻¹ y − ½ ln det K + 24 ln ρ − 4 ρ − α² / 8 − σ² / 2 + Σ u, with K_ij = α² exp(−(x_i − x_j)² / 2 ρ²) + σ [i = j].
fn gaussian_process(y: &[f64], x: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let [rho, alpha, sigma] = [u[0].exp(), u[1].exp(), u[2].exp()];
    let n = x.len();
    let distance = |e: usize| ((x[e / n] - x[e % n]) / rho).powi(2);
    let signal: Vec<f64> = (0..n * n).map(|e| alpha * alpha * (-0.5 * distance(e)).exp()).collect();
    let mut k = signal.clone();
    (0..n).for_each(|i| k[i * (n + 1)] += sigma);
    let Ok(factor) = cholesky("K", &k, n) else { return f64::NEG_INFINITY };
    if factor.jitter > 0.0 {
        return f64::NEG_INFINITY;
    }
    let whitening = inverse_lower(&factor.lower, n);
    let inverse: Vec<f64> =
        (0..n * n).map(|e| (0..n).map(|l| whitening[l * n + e / n] * whitening[l * n + e % n]).sum()).collect();
    let weights: Vec<f64> = inverse.chunks(n).map(|row| row.iter().zip(y).map(|(a, y)| a * y).sum()).collect();
    // ½ wᵀ D w − ½ tr(K⁻¹ D) for a derivative D of K.
    let by = |derivative: &dyn Fn(usize) -> f64| -> f64 {
        (0..n * n).map(|e| 0.5 * (weights[e / n] * weights[e % n] - inverse[e]) * derivative(e)).sum()
    };
    grad[0] = by(&|e| signal[e] * distance(e)) + 24.0 - 4.0 * rho + 1.0;
    grad[1] = by(&|e| 2.0 * signal[e]) - 0.25 * alpha * alpha + 1.0;
    grad[2] = by(&|e| if e / n == e % n { sigma } else { 0.0 }) - sigma * sigma + 1.0;
    let log_det: f64 = (0..n).map(|i| 2.0 * factor.lower[i * (n + 1)].ln()).sum();
    let fit: f64 = weights.iter().zip(y).map(|(w, y)| w * y).sum();
    -0.5 * fit - 0.5 * log_det + 24.0 * u[0] - 4.0 * rho - alpha * alpha / 8.0 - 0.5 * sigma * sigma
        + u.iter().sum::<f64>()
}

/// Which sampler is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Trajectories of tuned length.
    Hmc,
    /// No-U-turn trees.
    Nuts,
}

/// Chains, all lanes of two blocks.
const CHAINS: usize = 2 * LANES;

/// Metric and starts after three rounds of no-U-turn chains.
///
/// # Errors
/// Where no step size or metric is found.
fn warm_up(posterior: &Posterior, stage: &Stage) -> Result<(Metric, Vec<Block>), Error> {
    let (d, isa) = (posterior.dim(), Isa::best());
    let mut states = vec![Block::ZERO; CHAINS / LANES * d];
    stage.round(0).whole().fill_normal(isa, &mut states);
    let mut metric = Metric::Diagonal(vec![1.0; d]);
    for (round, updates) in [(1, 150), (2, 300), (3, 600)] {
        let [to_tune, to_draw] = stage.round(round).split(["tune", "draw"]);
        let config = tuning::Config { first_step_size: 0.1, updates: 20, jitter: 0.1, ..tuning::Config::default() };
        let mut trial = Trial { target: posterior, metric: &metric, states: states.clone(), isa };
        let tuned = tuning::no_u_turn(&mut trial, &config, 10, &[0.8], &to_tune)?;
        let nuts = Nuts::with_metric(tuned.step_size, &metric, 10, 0.1, isa)?;
        let schedule = Schedule { updates, burn_in: updates / 2 };
        let draws = nuts::draw(posterior, &nuts, &trial.states, CHAINS, schedule, &to_draw)?.draws;
        let effective = (0..d).map(|j| effective_sample_size(&draws.series(j))).fold(f64::INFINITY, f64::min);
        metric = learned::metric(posterior, &draws, effective, isa)?;
        states = draws.last;
    }
    Ok((metric, states))
}

/// Draws of a sampler after the warm-up, `updates` a chain.
///
/// # Errors
/// Those of the warm-up and of tuning.
pub fn sampled(posterior: &Posterior, sampler: Sampler, updates: usize, seed: u64) -> Result<Draws, Error> {
    let isa = Isa::best();
    let [to_warm, to_tune, to_draw] = Stage::new(seed, &posterior.name).split(["warm up", "tune", "draw"]);
    let (metric, states) = warm_up(posterior, &to_warm)?;
    // Trajectories of one length near half a period turn means about and leave spreads where they are; lengths that scatter by half mix both.
    let jitter = if sampler == Sampler::Hmc { 0.5 } else { 0.2 };
    let config = tuning::Config { jitter, lengths: vec![3, 5, 8, 12], ..tuning::Config::default() };
    let mut trial = Trial { target: posterior, metric: &metric, states, isa };
    let schedule = Schedule { updates, burn_in: 50.min(updates) };
    match sampler {
        Sampler::Hmc => {
            let tuned = tuning::cheapest(&mut trial, &config, &[0.95], &to_tune)?;
            let hmc = Hmc::with_metric(tuned.step_size, &metric, tuned.leapfrog_steps, jitter, isa)?;
            draw(posterior, &hmc, &trial.states, CHAINS, schedule, &to_draw)
        }
        Sampler::Nuts => {
            let tuned = tuning::no_u_turn(&mut trial, &config, 10, &[0.95], &to_tune)?;
            let nuts = Nuts::with_metric(tuned.step_size, &metric, 10, jitter, isa)?;
            Ok(nuts::draw(posterior, &nuts, &trial.states, CHAINS, schedule, &to_draw)?.draws)
        }
    }
}

/// `posteriordb`: every mean and standard deviation within 4 √(m² + mcse²) of the reference, R̂ at most 1.01 (split and rank-normalised), divergences as allowed.
#[must_use]
pub fn judged(posterior: &Posterior, sampler: Sampler, updates: usize, seed: u64) -> Vec<Finding> {
    let name = format!("{}, {sampler:?}", posterior.name);
    let draws = match sampled(posterior, sampler, updates, seed) {
        Ok(draws) => draws,
        Err(error) => return vec![Finding::at_most(format!("{name}: {error}"), f64::NAN, 0.0, "did not run")],
    };
    let unconstrained: Vec<Vec<Vec<f64>>> = (0..posterior.dim()).map(|j| draws.series(j)).collect();
    let (chains, length) = (draws.chains, unconstrained[0][0].len());
    let names = posterior.names();
    let mut series = vec![vec![Vec::with_capacity(length); chains]; names.len()];
    for chain in 0..chains {
        for k in 0..length {
            let u: Vec<f64> = unconstrained.iter().map(|s| s[chain][k]).collect();
            series.iter_mut().zip(posterior.constrained(&u)).for_each(|(s, x)| s[chain].push(x));
        }
    }
    let allowed = posterior.divergences as f64;
    let kept = draws.stats.iter().filter(|s| s.divergent).count() as f64;
    let mut findings =
        vec![Finding::at_most(format!("{name}: divergences"), kept, allowed, format!("{} draws", draws.stats.len()))];
    let worst = |of: &dyn Fn(&Vec<Vec<f64>>) -> f64| {
        series.iter().map(of).fold(0.0, |a: f64, b| if b > a || b.is_nan() { b } else { a })
    };
    findings.push(Finding::at_most(format!("{name}: split R-hat"), worst(&|s| split_r_hat(s)), 1.01, ""));
    findings.push(Finding::at_most(format!("{name}: rank R-hat"), worst(&|s| rank_r_hat(s)), 1.01, ""));
    for (quantity, chains) in names.iter().zip(&series) {
        let reference = &posterior.stored["reference"][quantity];
        let n = (chains.len() * length) as f64;
        let all = || chains.iter().flatten();
        let mean = all().sum::<f64>() / n;
        let variance = all().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
        let sd = variance.sqrt();
        let squares: Vec<Vec<f64>> = chains.iter().map(|c| c.iter().map(|x| (x - mean).powi(2)).collect()).collect();
        let spread = squares.iter().flatten().map(|x| (x - variance).powi(2)).sum::<f64>() / n;
        let ess = bulk_ess(chains);
        let of_mean = sd / effective_sample_size(chains).sqrt();
        // The error of a root is that of its square over twice the root.
        let of_sd = (spread / effective_sample_size(&squares)).sqrt() / (2.0 * sd);
        for (what, found, m, exact, mcse) in
            [("mean", mean, of_mean, "mean", "mcse_mean"), ("sd", sd, of_sd, "sd", "mcse_sd")]
        {
            let (exact, mcse) = (number(&reference[exact]), number(&reference[mcse]));
            let detail = format!("{found:.5} ± {m:.5} against {exact:.5} ± {mcse:.5}, bulk ESS {ess:.0}, seed {seed}");
            findings.push(Finding::score(
                format!("{name}: {what} of {quantity}"),
                (found - exact) / m.hypot(mcse),
                4.0,
                detail,
            ));
        }
    }
    findings
}
