//! The bootstrap filter against exact evidence and means (evidence E2, order of the error E3, `evidence-unbiased`).
//!
//! Unbiasedness under every scheme and threshold, the stored table, and the order of its error.

use crate::finding::{Finding, mean_and_error};
use crate::linear_series::{Series, deviations};
use sinew::core::random::Stage;
use sinew::samplers::resample::Scheme;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{Bootstrap, Config};

/// All schemes.
pub const SCHEMES: [Scheme; 4] = [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic];
/// Effective part below which the filter resamples; 1 is always.
pub const THRESHOLDS: [f64; 3] = [0.2, 0.5, 1.0];

/// Error of log Z, and the mean over frames and coordinates of the squared error of the mean in exact standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// log Ẑ − log Z.
    pub log_evidence: f64,
    /// Mean squared error of the means.
    pub square: f64,
}

/// One run of the filter on a series.
///
/// # Panics
/// Where all weights are zero.
#[must_use]
pub fn run(series: &Series, config: &Config, stage: &Stage) -> Errors {
    let exact = series.kalman();
    let mut filter = Bootstrap::new(config.clone(), series.model(), series.m0.clone()).expect("valid");
    let (mut log_evidence, mut square) = (0.0, 0.0);
    for (frame, exact) in exact.iter().enumerate() {
        let info = filter.step(&series.sight(frame), stage.round(frame)).expect("weights");
        log_evidence += info.log_evidence.unwrap_or(f64::NAN) - exact.log_likelihood;
        let sd = deviations(&exact.filtered);
        for ((found, exact), sd) in info.mean.iter().zip(&exact.filtered.mean).zip(sd) {
            square += ((found - exact) / sd).powi(2);
        }
    }
    Errors { log_evidence, square: square / (exact.len() * series.dim) as f64 }
}

/// Mean of Ẑ / Z over `runs` seeds for every scheme and threshold: within five standard errors of 1.
#[must_use]
pub fn unbiased(series: &Series, particles: usize, runs: usize, seed: u64) -> Vec<Finding> {
    let mut findings = vec![];
    for scheme in SCHEMES {
        for resample_below in THRESHOLDS {
            let config = Config { particles, scheme, resample_below };
            let name = format!("{scheme:?} below {resample_below}");
            let root = Stage::new(seed, &name);
            let ratios: Vec<f64> = (0..runs).map(|r| run(series, &config, &root.round(r)).log_evidence.exp()).collect();
            let [mean, error] = mean_and_error(&ratios);
            let detail = format!("mean of Z-hat / Z {mean:.3} ± {error:.3}, N = {particles}, {runs} runs, seed {seed}");
            findings.push(Finding::score(format!("evidence, {name}"), (mean - 1.0) / error, 5.0, detail));
        }
    }
    findings
}

/// N and what the data folder states for two dimensions: error of log Z (mean, sd) and of the means in exact standard deviations.
pub const STORED_D2: [(usize, [f64; 3]); 3] =
    [(250, [-0.13, 0.63, 0.138]), (1000, [-0.05, 0.31, 0.069]), (4000, [-0.01, 0.15, 0.035])];

/// The stored table: no run further than five standard deviations from Z, and the error of the means within 10 % and five standard errors of what is stored.
#[must_use]
pub fn stored_table(series: &Series, runs: usize, seed: u64) -> Vec<Finding> {
    let mut findings = vec![];
    for (particles, [_, sd, error]) in STORED_D2 {
        let config = Config { particles, ..Config::default() };
        let root = Stage::new(seed, "stored table").round(particles);
        let found: Vec<Errors> = (0..runs).map(|r| run(series, &config, &root.round(r))).collect();
        let worst = found.iter().map(|e| e.log_evidence.abs()).fold(0.0, f64::max);
        let of = format!("N = {particles}, {runs} runs");
        findings.push(Finding::at_most(format!("largest error of log Z, {of}"), worst, 5.0 * sd, "5 sd"));
        let roots: Vec<f64> = found.iter().map(|e| e.square.sqrt()).collect();
        let [mean, se] = mean_and_error(&roots);
        let wide = 0.1 * error + 5.0 * se;
        let detail = format!("± {se:.4}; stored {error}");
        findings.push(Finding::between(format!("err/sd, {of}"), mean, [error - wide, error + wide], detail));
    }
    findings
}

/// Order of the error (E3): the error of the mean falls as N^(−1/2) over N = 250 · 4^k, k = 0 … `most`; the slope is that of the logarithms of root mean squares over `runs` runs.
#[must_use]
pub fn error_slope(series: &Series, most: u32, runs: usize, seed: u64) -> Finding {
    let points: Vec<[f64; 2]> = (0..=most)
        .map(|k| {
            let particles = 250 * 4_usize.pow(k);
            let config = Config { particles, ..Config::default() };
            let root = Stage::new(seed, "error slope").round(particles);
            let square: f64 = (0..runs).map(|r| run(series, &config, &root.round(r)).square).sum();
            [(particles as f64).ln(), 0.5 * (square / runs as f64).ln()]
        })
        .collect();
    let detail = format!("{points:.3?}, {runs} runs each, seed {seed}");
    Finding::between("slope of the error in N", slope(&points), [-0.6, -0.4], detail)
}

/// Slope of the straight line through points.
#[must_use]
pub fn slope(points: &[[f64; 2]]) -> f64 {
    let n = points.len() as f64;
    let mean = |k: usize| points.iter().map(|p| p[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>()
}
