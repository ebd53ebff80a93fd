//! The HMC filter with the paper's mixture prior against the Kalman filter (E4, `hmc-filter-kalman`).
//!
//! And against the ideal: exact draws from the same mixture target.

use crate::evidence::Errors;
use crate::finding::{Finding, mean_and_error};
use crate::linear_series::{MixtureBetween, Series, deviations, product};
use sinew::core::lanes::Isa;
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::Moments;
use sinew::dynamics::kalman::Form;
use sinew::samplers::resample::multinomial;
use sinew::samplers::weights::normalise;
use sinew::tracking::hmc_filter::{Config, HmcFilter};
use sinew::tracking::{Inferred, Tracker};

/// Errors of one run: of log Z and means as for particles, and the mean squared relative error of the variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterErrors {
    /// log Ẑ and means.
    pub errors: Errors,
    /// Mean over frames and coordinates of (variance / exact − 1)².
    pub variance_error: f64,
}

struct Tally {
    found: FilterErrors,
    count: f64,
}

impl Tally {
    fn new() -> Self {
        let errors = Errors { log_evidence: 0.0, square: 0.0 };
        Self { found: FilterErrors { errors, variance_error: 0.0 }, count: 0.0 }
    }

    fn add(&mut self, mean: &[f64], variances: &[f64], log_evidence: f64, exact: &Moments) {
        self.found.errors.log_evidence += log_evidence;
        for (j, sd) in deviations(exact).into_iter().enumerate() {
            self.found.errors.square += ((mean[j] - exact.mean[j]) / sd).powi(2);
            self.found.variance_error += (variances[j] / (sd * sd) - 1.0).powi(2);
            self.count += 1.0;
        }
    }

    fn end(mut self) -> FilterErrors {
        self.found.errors.square /= self.count;
        self.found.variance_error /= self.count;
        self.found
    }
}

/// Settings for `chains` chains on a linear series.
#[must_use]
pub fn config(chains: usize) -> Config {
    Config {
        chains,
        updates: 20,
        burn_in: 8,
        step_size: 0.7,
        leapfrog_steps: 5,
        jitter: 0.2,
        curvature_draws: 8,
        ..Config::default()
    }
}

/// One run of the filter with `chains` chains.
///
/// # Panics
/// Where a frame has no posterior.
#[must_use]
pub fn hmc(series: &Series, chains: usize, stage: &Stage) -> FilterErrors {
    let (white, lower) = series.whitened();
    let d = series.dim;
    let transposed: Vec<f64> = (0..d * d).map(|e| lower[e % d * d + e / d]).collect();
    let mut filter =
        HmcFilter::new(config(chains), MixtureBetween::new(&white), white.m0.clone(), Isa::best()).expect("valid");
    let mut tally = Tally::new();
    for (frame, exact) in series.kalman().iter().enumerate() {
        let info = filter.step(&white.sight(frame), stage.round(frame)).expect("posterior");
        let moments = filter.posterior().moments(Isa::best());
        let mean: Vec<f64> =
            lower.chunks(d).map(|row| row.iter().zip(&moments.mean).map(|(l, m)| l * m).sum()).collect();
        let covariance = product(&product(&lower, &moments.covariance, d), &transposed, d);
        let variances: Vec<f64> = covariance.iter().step_by(d + 1).copied().collect();
        let log_evidence = info.log_evidence.unwrap_or(f64::NAN) - exact.log_likelihood;
        tally.add(&mean, &variances, log_evidence, &exact.filtered);
    }
    tally.end()
}

/// Standard normal deviates.
fn normals(count: usize, rng: &mut BlockRng) -> Vec<f64> {
    let mut blocks = vec![sinew::core::lanes::Block::ZERO; count.div_ceil(8)];
    rng.fill_normal(Isa::baseline(), &mut blocks);
    blocks.iter().flat_map(|b| b.0).take(count).collect()
}

/// One run with exact draws: each component's posterior is a Gaussian, its weight the density of the observation given that component.
///
/// # Panics
/// Where the model is degenerate.
#[must_use]
pub fn ideal(series: &Series, chains: usize, stage: &Stage) -> FilterErrors {
    let d = series.dim;
    let filter = series.filter(Form::Joseph);
    let mut states: Vec<Vec<f64>> = vec![];
    let mut tally = Tally::new();
    for (frame, exact) in series.kalman().iter().enumerate() {
        let mut rng = stage.round(frame).whole();
        let z: Vec<Option<f64>> = series.z[frame].iter().copied().map(Some).collect();
        let components: Vec<Moments> = if frame == 0 {
            vec![series.start()]
        } else {
            let moved = |x: &Vec<f64>| -> Vec<f64> {
                series.a.chunks(d).map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
            };
            states.iter().map(|x| Moments { mean: moved(x), covariance: series.q.clone() }).collect()
        };
        let mut log_weights = vec![];
        let mut posteriors = vec![];
        for component in &components {
            let start = filter.start(component).expect("positive definite");
            let (after, log) = filter.update(&start, &z).expect("positive definite");
            posteriors.push(after.moments());
            log_weights.push(log);
        }
        let mut weights = vec![];
        let log_evidence = normalise(&log_weights, &mut weights).expect("weights") - (components.len() as f64).ln();
        let root = sinew::dynamics::factor::cholesky("posterior", &posteriors[0].covariance, d)
            .expect("positive definite")
            .lower;
        states = multinomial(&weights, chains, &mut rng)
            .into_iter()
            .map(|i| {
                let noise = normals(d, &mut rng);
                let shift = root.chunks(d).map(|row| row.iter().zip(&noise).map(|(r, z)| r * z).sum::<f64>());
                posteriors[i].mean.iter().zip(shift).map(|(m, s)| m + s).collect()
            })
            .collect();
        let n = chains as f64;
        let mean: Vec<f64> = (0..d).map(|j| states.iter().map(|x| x[j]).sum::<f64>() / n).collect();
        let variance = |j: usize| states.iter().map(|x| (x[j] - mean[j]).powi(2)).sum::<f64>() / (n - 1.0);
        let variances: Vec<f64> = (0..d).map(variance).collect();
        tally.add(&mean, &variances, log_evidence - exact.log_likelihood, &exact.filtered);
    }
    tally.end()
}

/// Against ideal draws (E4): errors of the filter's means at most 1.3 × the errors of ideal draws as stored, and of its variances at most 1.3 × the errors of ideal draws made here with the same number of chains and runs.
#[must_use]
pub fn against_ideal(series: &Series, name: &str, chains: usize, stored: f64, runs: usize, seed: u64) -> Vec<Finding> {
    let root = Stage::new(seed, "mixture filter").round(chains);
    let [to_move, to_draw] = root.split(["hmc", "ideal"]);
    let found: Vec<FilterErrors> = (0..runs).map(|r| hmc(series, chains, &to_move.round(r))).collect();
    let best: Vec<FilterErrors> = (0..runs).map(|r| ideal(series, chains, &to_draw.round(r))).collect();
    let of = format!("{name}, {chains} chains, {runs} runs");
    let roots = |of: &[FilterErrors], value: &dyn Fn(&FilterErrors) -> f64| {
        mean_and_error(&of.iter().map(|f| value(f).sqrt()).collect::<Vec<_>>())
    };
    let [means, se] = roots(&found, &|f| f.errors.square);
    let [ideal_means, ideal_se] = roots(&best, &|f| f.errors.square);
    let [variances, _] = roots(&found, &|f| f.variance_error);
    let [ideal_variances, _] = roots(&best, &|f| f.variance_error);
    vec![
        Finding::at_most(
            format!("err/sd of the means over the ideal's, {of}"),
            means / stored,
            1.3,
            format!("{means:.4} ± {se:.4}; ideal {stored} stored, {ideal_means:.4} ± {ideal_se:.4} here"),
        ),
        Finding::at_most(
            format!("relative error of the variances over the ideal's, {of}"),
            variances / ideal_variances,
            1.3,
            format!("{variances:.4} against {ideal_variances:.4}"),
        ),
    ]
}
