//! Variance of an estimator against its cost, and the ratio of two costs at equal variance.
//!
//! Each setting of an estimator is run several times; its variance is the geometric mean over the variables of the squared errors about a reference. Intervals come from a bootstrap over the runs.

use sinew::core::lanes::Block;
use sinew::core::random::Stage;

/// A cell: what it costs and what its runs estimated.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Wall time of a run on one thread, seconds.
    pub seconds: f64,
    /// Likelihood evaluations, a gradient counted as several.
    pub units: f64,
    /// Squared errors of the means about the reference: run by run, variable by variable.
    pub squares: Vec<Vec<f64>>,
    /// Median effective number of particles; NaN for chains.
    pub effective: f64,
    /// Mean acceptance; NaN for particles.
    pub acceptance: f64,
}

/// Whose cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Likelihood evaluations.
    Units,
    /// Wall time.
    Seconds,
}

impl Cell {
    /// What a run costs.
    #[must_use]
    pub fn cost(&self, axis: Axis) -> f64 {
        match axis {
            Axis::Units => self.units,
            Axis::Seconds => self.seconds,
        }
    }

    /// Variance v_k of each variable and its standard error.
    #[must_use]
    pub fn variances(&self) -> Vec<[f64; 2]> {
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
    #[must_use]
    pub fn log_mean(&self) -> f64 {
        self.log_mean_of(&(0..self.squares.len()).collect::<Vec<_>>())
    }

    /// Its standard error by a bootstrap over the runs.
    #[must_use]
    pub fn log_mean_error(&self, stage: &Stage) -> f64 {
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
    let mut uniform = vec![Block::ZERO; count.div_ceil(8)];
    stage.round(replicate).whole().fill_uniform(&mut uniform);
    uniform.iter().flat_map(|block| block.0).take(count).map(|u| (u * count as f64) as usize).collect()
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
pub enum At {
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
pub struct Ratio {
    /// The ratio.
    pub value: f64,
    /// 2.5 % and 97.5 % of the bootstrap over runs.
    pub interval: [f64; 2],
    /// Whether the curve of the particles was extrapolated.
    pub extrapolated: bool,
}

/// The ratio with its interval.
#[must_use]
pub fn ratio(particles: &[Cell], chains: &[Cell], axis: Axis, at: At, stage: &Stage) -> Ratio {
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

/// Geometric mean of ratios over frames with the 95 % interval that follows from the ratios of the frames.
#[must_use]
pub fn over_frames(ratios: &[Ratio]) -> [f64; 3] {
    let logs: Vec<f64> = ratios.iter().map(|r| r.value.ln()).collect();
    let variance = |r: &Ratio| ((r.interval[1] / r.interval[0]).ln() / (2.0 * 1.96)).powi(2);
    let error = ratios.iter().map(variance).sum::<f64>().sqrt() / ratios.len() as f64;
    let middle = logs.iter().sum::<f64>() / logs.len() as f64;
    [middle, middle - 1.96 * error, middle + 1.96 * error].map(f64::exp)
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
    fn ratios_of_runs_have_intervals_that_hold_them() {
        let square = |k: usize| 1.0 + (k as f64 * 1.7).sin();
        let cell = |units: f64, scale: f64| Cell {
            seconds: units,
            units,
            squares: (0..40).map(|k| vec![scale * square(k), scale * square(k + 40)]).collect(),
            effective: f64::NAN,
            acceptance: f64::NAN,
        };
        let curve = |factor: f64| [10.0, 100.0, 1000.0].map(|cost| cell(cost, factor / cost));
        let stage = Stage::new(1, "equal variance");
        let found = ratio(&curve(10.0), &curve(1.0), Axis::Units, At::Common, &stage);
        let [low, high] = found.interval;
        assert!((found.value - 10.0).abs() < 1e-9 && low < 10.0 && high > 10.0 && high / low < 4.0, "{found:?}");
        let [middle, below, above] = over_frames(&[found, found]);
        assert!((middle - 10.0).abs() < 1e-9 && below > low && above < high, "{below} {above}");
    }
}
