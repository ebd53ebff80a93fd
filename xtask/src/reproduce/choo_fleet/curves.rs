//! Variance of an estimator against its cost, and the ratio of two costs at equal variance.
//!
//! Fifty runs, the geometric mean over the state's variables.

use super::chains::Variant;
use super::problem::Model;
use super::scene::Source;
use super::single::Setting;
use super::study::{Study, cell_key, factor_key, reference_key};
use crate::outcome::Outcome;
use crate::store::{Store, numbers, rows};
use serde_json::Value;
use sinew::core::random::Stage;

/// A cell: what it costs and what its runs estimated.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    /// Wall time of a run on one thread, seconds.
    pub(super) seconds: f64,
    /// Likelihood evaluations, a gradient counted as so many.
    pub(super) units: f64,
    /// Squared errors of the means about the reference: run by run, variable by variable.
    pub(super) squares: Vec<Vec<f64>>,
    /// Median effective number of particles; NaN for chains.
    pub(super) effective: f64,
    /// Mean acceptance; NaN for particles.
    pub(super) acceptance: f64,
}

/// Whose cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Units,
    Seconds,
}

impl Cell {
    /// From what was stored, the mean of the reference, and the cost of a gradient in likelihoods.
    pub(super) fn of(value: &Value, mean: &[f64], factor: f64) -> Self {
        let number = |name: &str| value[name].as_f64().unwrap_or(f64::NAN);
        let square = |run: &Vec<f64>| run.iter().zip(mean).map(|(a, b)| (a - b).powi(2)).collect();
        let mut effective = numbers(&value["effective"]);
        effective.sort_by(f64::total_cmp);
        let acceptance = numbers(&value["acceptance"]);
        Self {
            seconds: number("seconds"),
            units: number("likelihoods") + factor * number("gradients"),
            squares: rows(&value["means"]).iter().map(square).collect(),
            effective: effective.get(effective.len() / 2).copied().unwrap_or(f64::NAN),
            acceptance: acceptance.iter().sum::<f64>() / acceptance.len() as f64,
        }
    }

    pub(super) fn cost(&self, axis: Axis) -> f64 {
        match axis {
            Axis::Units => self.units,
            Axis::Seconds => self.seconds,
        }
    }

    /// Variance v_k of each variable and its standard error.
    pub(super) fn variances(&self) -> Vec<[f64; 2]> {
        let n = self.squares.len() as f64;
        (0..self.squares.first().map_or(0, Vec::len))
            .map(|k| {
                let mean = self.squares.iter().map(|run| run[k]).sum::<f64>() / n;
                let spread = self.squares.iter().map(|run| (run[k] - mean).powi(2)).sum::<f64>() / (n - 1.0);
                [mean, (spread / n).sqrt()]
            })
            .collect()
    }

    /// Logarithm of the geometric mean of the variances, over the runs of the given numbers.
    fn log_mean_of(&self, runs: &[usize]) -> f64 {
        let d = self.squares.first().map_or(0, Vec::len);
        let log = |k: usize| (runs.iter().map(|&r| self.squares[r][k]).sum::<f64>() / runs.len() as f64).ln();
        (0..d).map(log).sum::<f64>() / d as f64
    }

    /// Logarithm of the geometric mean of the variances.
    pub(super) fn log_mean(&self) -> f64 {
        self.log_mean_of(&(0..self.squares.len()).collect::<Vec<_>>())
    }

    /// Its standard error by a bootstrap over the runs.
    pub(super) fn log_mean_error(&self, stage: &Stage) -> f64 {
        let values: Vec<f64> =
            (0..REPLICATES).map(|r| self.log_mean_of(&resampled(self.squares.len(), stage, r))).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
    }
}

/// Replicates of a bootstrap.
const REPLICATES: usize = 1000;

/// Numbers of runs drawn with replacement.
fn resampled(count: usize, stage: &Stage, replicate: usize) -> Vec<usize> {
    let mut uniform = vec![sinew::core::lanes::Block::ZERO; count.div_ceil(8)];
    stage.round(replicate).whole().fill_uniform(&mut uniform);
    uniform.iter().flat_map(|block| block.0).take(count).map(|u| (u * count as f64) as usize).collect()
}

/// The cells of one contender in one frame, by rising cost.
pub(super) fn curve(
    study: &Study,
    store: &Store,
    source: Source,
    frame: usize,
    model: &Model,
    of: Option<Variant>,
) -> Outcome<Vec<Cell>> {
    let reference = store.get(&reference_key(source, frame, model)).ok_or("a reference is missing")?;
    let mean = numbers(&reference["mean"]);
    let factor = store.get(&factor_key(model)).and_then(|f| f.as_f64()).ok_or("a gradient factor is missing")?;
    let mut cells = vec![];
    for setting in study.settings(model) {
        let belongs = match setting {
            Setting::Particles(_) => of.is_none(),
            Setting::Updates(variant, _) => of == Some(variant),
        };
        if !belongs {
            continue;
        }
        let key = cell_key(source, frame, model, &setting);
        let value = store.get(&key).ok_or(format!("the cell {key} is missing"))?;
        cells.push(Cell::of(value, &mean, factor));
    }
    Ok(cells)
}

/// Logarithm of the cost at which a curve of (log cost, log variance) reaches a variance: linear between its points, falling as 1/cost beyond the last.
fn log_cost_at(curve: &[(f64, f64)], log_variance: f64) -> f64 {
    let Some(&(first_cost, first)) = curve.first() else { return f64::NAN };
    if log_variance >= first {
        return first_cost;
    }
    for pair in curve.windows(2) {
        let [(a, u), (b, v)] = [pair[0], pair[1]];
        if v <= log_variance && log_variance <= u {
            return a + (b - a) * (u - log_variance) / (u - v);
        }
    }
    let (cost, variance) = curve[curve.len() - 1];
    cost + (variance - log_variance).max(0.0)
}

/// How costs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum At {
    /// At the variance of the chains' longest run where the particles reach it, else at the largest variance that both have.
    Common,
    /// At the variance of the chains' longest run, the particles' variance extrapolated by 1/N.
    Extrapolated,
}

/// Logarithm of the cost of particles over that of chains at equal variance, and whether the particles' curve had to be extrapolated.
fn log_ratio(particles: &[(f64, f64)], chains: &[(f64, f64)], at: At) -> (f64, bool) {
    let last = |curve: &[(f64, f64)]| curve.last().map_or(f64::NAN, |p| p.1);
    let first = |curve: &[(f64, f64)]| curve.first().map_or(f64::NAN, |p| p.1);
    let target = last(chains);
    let beyond = target < last(particles);
    let common = first(particles).min(first(chains));
    let level = match at {
        At::Extrapolated => target.min(first(particles)),
        At::Common if beyond || target > first(particles) => common,
        At::Common => target,
    };
    (log_cost_at(particles, level) - log_cost_at(chains, level), beyond && at == At::Extrapolated)
}

/// Cost of particles over cost of chains at equal variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    pub(super) value: f64,
    /// 2.5 % and 97.5 % of the bootstrap over runs.
    pub(super) interval: [f64; 2],
    pub(super) extrapolated: bool,
}

/// The ratio with its interval.
pub(super) fn ratio(particles: &[Cell], chains: &[Cell], axis: Axis, at: At, stage: &Stage) -> Ratio {
    let points = |cells: &[Cell], runs: &dyn Fn(usize, usize) -> Vec<usize>| -> Vec<(f64, f64)> {
        cells.iter().enumerate().map(|(i, c)| (c.cost(axis).ln(), c.log_mean_of(&runs(i, c.squares.len())))).collect()
    };
    let all = |_: usize, count: usize| (0..count).collect::<Vec<_>>();
    let (value, extrapolated) = log_ratio(&points(particles, &all), &points(chains, &all), at);
    let mut replicates: Vec<f64> = (0..REPLICATES)
        .map(|r| {
            let drawn = |offset: usize| move |i: usize, count: usize| resampled(count, stage, r * 64 + offset + i);
            log_ratio(&points(particles, &drawn(0)), &points(chains, &drawn(32)), at).0
        })
        .collect();
    replicates.sort_by(f64::total_cmp);
    let quantile = |q: f64| replicates[(q * (replicates.len() - 1) as f64).round() as usize].exp();
    Ratio { value: value.exp(), interval: [quantile(0.025), quantile(0.975)], extrapolated }
}

/// Slope of log variance against log R from R = 32 on.
pub(super) fn slope(study: &Study, cells: &[Cell]) -> f64 {
    let points: Vec<(f64, f64)> = study
        .size
        .doublings
        .iter()
        .zip(cells)
        .filter(|(doubling, _)| **doubling >= 2)
        .map(|(doubling, cell)| (f64::from(*doubling) * std::f64::consts::LN_2, cell.log_mean()))
        .collect();
    let n = points.len() as f64;
    let [x, y] = [points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n];
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Geometric mean of ratios over frames with the 95 % interval that follows from those of the frames.
pub(super) fn over_frames(ratios: &[Ratio]) -> [f64; 3] {
    let logs: Vec<f64> = ratios.iter().map(|r| r.value.ln()).collect();
    let variance = |r: &Ratio| ((r.interval[1] / r.interval[0]).ln() / (2.0 * 1.96)).powi(2);
    let error = ratios.iter().map(variance).sum::<f64>().sqrt() / ratios.len() as f64;
    let middle = logs.iter().sum::<f64>() / logs.len() as f64;
    [middle, middle - 1.96 * error, middle + 1.96 * error].map(f64::exp)
}

/// Base-ten logarithms of the volume ratio of prior and posterior: by marginal standard deviations and by determinants.
pub(super) fn volumes(
    store: &Store,
    source: Source,
    frame: usize,
    model: &Model,
    prior_sd: &[f64],
) -> Outcome<[f64; 2]> {
    let reference = store.get(&reference_key(source, frame, model)).ok_or("a reference is missing")?;
    Ok(volumes_of(reference, prior_sd))
}

/// The same of a reference.
pub(super) fn volumes_of(reference: &Value, prior_sd: &[f64]) -> [f64; 2] {
    let covariance = numbers(&reference["covariance"]);
    let d = prior_sd.len();
    let prior: f64 = prior_sd.iter().map(|sd| sd.log10()).sum();
    let marginal: f64 = (0..d).map(|j| 0.5 * covariance[j * d + j].log10()).sum();
    [prior - marginal, prior - 0.5 * log10_det(covariance, d)]
}

/// Base-ten logarithm of the determinant of a positive definite matrix.
fn log10_det(mut m: Vec<f64>, d: usize) -> f64 {
    let mut log = 0.0;
    for k in 0..d {
        let pivot = m[k * d + k];
        log += pivot.log10();
        for i in k + 1..d {
            let factor = m[i * d + k] / pivot;
            for j in k..d {
                m[i * d + j] -= factor * m[k * d + j];
            }
        }
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_at_equal_variance() {
        // Variance 1/cost against 10/cost: ten times the cost.
        let line = |factor: f64, costs: &[f64]| -> Vec<(f64, f64)> {
            costs.iter().map(|c| (c.ln(), (factor / c).ln())).collect()
        };
        let (slow, fast) = (line(10.0, &[10.0, 100.0, 1000.0]), line(1.0, &[3.0, 30.0]));
        for at in [At::Common, At::Extrapolated] {
            let (log, extrapolated) = log_ratio(&slow, &fast, at);
            assert!((log.exp() - 10.0).abs() < 1e-9 && !extrapolated, "{at:?} {}", log.exp());
        }
        let (log, extrapolated) = log_ratio(&slow[..2], &line(1.0, &[3.0, 300.0]), At::Extrapolated);
        assert!((log.exp() - 10.0).abs() < 1e-9 && extrapolated);
    }

    #[test]
    fn determinants_of_known_matrices() {
        assert!((log10_det(vec![4.0, 2.0, 2.0, 26.0], 2) - 2.0).abs() < 1e-12);
    }
}
