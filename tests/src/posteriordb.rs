//! Five posteriors of posteriordb as unconstrained densities with gradients, and what a sampler makes of them.
//!
//! The data are BSD-3-Clause (`posteriordb/LICENCE-posteriordb.md` of the data folder). Each file states its density; in `densities` it is written by hand with its gradient and checked against the stored points before anything is sampled.
//! Chains start where Stan's do, or from a standard normal, and `warm_up` knows nothing of the posterior.

mod densities;

use crate::finding::Finding;
use crate::linear_series::rows;
use crate::stored::{number, numbers, stored};
use serde_json::Value;
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::diagnostics::{bulk_ess, effective_sample_size, rank_r_hat, split_r_hat};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::samplers::Error;
use sinew::samplers::chains::{ChainDraws, Schedule, draw_trajectories};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::nuts::{self, Nuts};
use sinew::samplers::starts::uniform_starts;
use sinew::samplers::tuning::{self, StepSizeTrial};
use sinew::samplers::warm_up::{self, WarmedUp, warm_up};

/// Which posterior, with its data.
#[derive(Clone, Debug)]
enum Model {
    /// Observations with their standard deviations; u = (θ̃_1 … θ̃_8, μ, ln τ).
    EightSchools { y: Vec<f64>, sigma: Vec<f64> },
    /// Observations and regressors; u = (β, ln σ).
    Regression { y: Vec<f64>, x: Vec<Vec<f64>> },
    /// Observations and their places; u = (ln ρ, ln α, ln σ).
    GaussianProcess { y: Vec<f64>, x: Vec<f64> },
    /// A series; u = (μ, φ, θ, ln σ).
    MovingAverage { y: Vec<f64> },
    /// Counts and their places; u = (ln ρ, ln α, f̃).
    PoissonProcess { counts: Vec<f64>, x: Vec<f64> },
}

/// A posterior with its reference.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// Its file's name.
    pub name: String,
    /// Divergent trajectories that are forgiven.
    pub divergences: usize,
    /// Acceptance at which it is sampled.
    acceptance: f64,
    /// How many times the draws of the others it takes.
    length: usize,
    /// The whole file.
    pub stored: Value,
    model: Model,
    dim: usize,
}

/// The posteriors; none, with a note, where the data folder is missing.
#[must_use]
pub fn all() -> Vec<Posterior> {
    let names = [
        ("eight_schools-eight_schools_noncentered", 5, 0.95, 1),
        ("sblrc-blr", 0, 0.95, 1),
        ("gp_pois_regr-gp_regr", 0, 0.95, 1),
        ("arma-arma11", 0, 0.95, 1),
        // Bent like a banana: small steps, and chains that take longer to forget.
        ("gp_pois_regr-gp_pois_regr", 5, 0.99, 2),
    ];
    let stored = |(name, divergences, acceptance, length): (&str, _, _, _)| {
        Some(Posterior { divergences, acceptance, length, ..Posterior::stored(name)? })
    };
    names.into_iter().filter_map(stored).collect()
}

impl Posterior {
    fn stored(name: &str) -> Option<Self> {
        let v = stored(&format!("posteriordb/{name}.json"))?;
        let data = &v["data"];
        let y = data.get("y").map(numbers).unwrap_or_default();
        let model = match name {
            "arma-arma11" => Model::MovingAverage { y },
            "gp_pois_regr-gp_pois_regr" => {
                Model::PoissonProcess { counts: numbers(&data["k"]), x: numbers(&data["x"]) }
            }
            "sblrc-blr" => Model::Regression { y, x: rows(&data["X"]) },
            "gp_pois_regr-gp_regr" => Model::GaussianProcess { y, x: numbers(&data["x"]) },
            _ => Model::EightSchools { y, sigma: numbers(&data["sigma"]) },
        };
        let dim = v["unconstrained_names"].as_array().expect("array").len();
        Some(Self { name: name.into(), divergences: 0, acceptance: 0.95, length: 1, stored: v, model, dim })
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
            Model::MovingAverage { .. } => u[..3].iter().copied().chain([u[3].exp()]).collect(),
            Model::PoissonProcess { x, .. } => {
                let f = densities::Latent::new(x, u).map_or_else(|| vec![f64::NAN; x.len()], |latent| latent.f);
                u[..2].iter().map(|u| u.exp()).chain(f).collect()
            }
        }
    }

    /// Names of the reference's quantities.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        match &self.model {
            Model::EightSchools { .. } => {
                (1..=8).map(|j| format!("theta[{j}]")).chain(["mu".into(), "tau".into()]).collect()
            }
            Model::Regression { .. } => (1..=5).map(|j| format!("beta[{j}]")).chain(["sigma".into()]).collect(),
            Model::GaussianProcess { .. } => ["rho", "alpha", "sigma"].map(String::from).into(),
            Model::MovingAverage { .. } => ["mu", "phi", "theta", "sigma"].map(String::from).into(),
            Model::PoissonProcess { x, .. } => {
                ["rho".into(), "alpha".into()].into_iter().chain((1..=x.len()).map(|i| format!("f[{i}]"))).collect()
            }
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
            Model::EightSchools { y, sigma } => densities::eight_schools(y, sigma, u, grad),
            Model::Regression { y, x } => densities::regression(y, x, u, grad),
            Model::GaussianProcess { y, x } => densities::gaussian_process(y, x, u, grad),
            Model::MovingAverage { y } => densities::moving_average(y, u, grad),
            Model::PoissonProcess { counts, x } => densities::poisson_process(counts, x, u, grad),
        };
        if value.is_finite() { value } else { f64::NEG_INFINITY }
    }
}

/// Which sampler is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Trajectories of tuned length.
    Hmc,
    /// No-U-turn trees.
    Nuts,
}

/// Where chains start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Starts {
    /// Uniform in (−2, 2) in every coordinate, as Stan's.
    Uniform,
    /// N(0, I).
    Normal,
}

/// Chains, all lanes of two blocks.
const CHAINS: usize = 2 * LANES;

/// Draws of a sampler after the warm-up, `updates` a chain, or as many times that as the posterior takes.
///
/// # Errors
/// As [`warm_up()`] and [`tuning`].
pub fn sampled(
    posterior: &Posterior,
    sampler: Sampler,
    starts: Starts,
    updates: usize,
    seed: u64,
) -> Result<ChainDraws, Error> {
    let isa = Isa::best();
    let [to_start, to_warm, to_tune, to_draw] =
        Stage::new(seed, &posterior.name).split(["start", "warm up", "tune", "draw"]);
    let starts = match starts {
        Starts::Uniform => uniform_starts(posterior, 2.0, CHAINS, &to_start)?,
        Starts::Normal => {
            let mut states = vec![Block::ZERO; CHAINS / LANES * posterior.dim()];
            to_start.whole().fill_normal(isa, &mut states);
            states
        }
    };
    let WarmedUp { metric, states, step_size, .. } =
        warm_up(posterior, &starts, CHAINS, &warm_up::Config::default(), isa, &to_warm)?;
    // Trajectories of one length near half a period turn means about and leave spreads where they are; lengths that scatter by half mix both.
    let jitter = if sampler == Sampler::Hmc { 0.5 } else { 0.2 };
    let lengths = vec![4, 8, 16, 32];
    let tolerance = 0.5 * (1.0 - posterior.acceptance);
    let config = tuning::Config { jitter, lengths, tolerance, first_step_size: step_size, ..tuning::Config::default() };
    let mut trial = StepSizeTrial { target: posterior, metric: &metric, states, isa };
    let updates = updates * posterior.length;
    let schedule = Schedule { updates, burn_in: 50.min(updates) };
    match sampler {
        Sampler::Hmc => {
            let tuned = tuning::cheapest(&mut trial, &config, &[posterior.acceptance], &to_tune)?;
            let hmc = Hmc::with_metric(tuned.step_size, &metric, tuned.leapfrog_steps, jitter, isa)?;
            draw_trajectories(posterior, &hmc, &trial.states, CHAINS, schedule, &to_draw)
        }
        Sampler::Nuts => {
            let tuned = tuning::no_u_turn(&mut trial, &config, 10, &[posterior.acceptance], &to_tune)?;
            let nuts = Nuts::with_metric(tuned.step_size, &metric, 10, jitter, isa)?;
            Ok(nuts::draw_trees(posterior, &nuts, &trial.states, CHAINS, schedule, &to_draw)?.draws)
        }
    }
}

/// `posteriordb`: every mean and standard deviation within 4 √(m² + mcse²) of the reference, R̂ at most 1.01 (split and rank-normalised), divergences as allowed.
#[must_use]
pub fn judged(posterior: &Posterior, sampler: Sampler, starts: Starts, updates: usize, seed: u64) -> Vec<Finding> {
    let name = format!("{}, {sampler:?}, {starts:?}", posterior.name);
    let draws = match sampled(posterior, sampler, starts, updates, seed) {
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
        let mean_error = sd / effective_sample_size(chains).sqrt();
        // The error of a root is that of its square over twice the root.
        let sd_error = (spread / effective_sample_size(&squares)).sqrt() / (2.0 * sd);
        for (what, found, m, exact, mcse) in
            [("mean", mean, mean_error, "mean", "mcse_mean"), ("sd", sd, sd_error, "sd", "mcse_sd")]
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
