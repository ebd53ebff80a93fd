//! What the HMC filter's two priors between frames cost in calibration.
//!
//! On a random walk with an exact filter, the growth model, and the arm whose depth can flip.

use crate::depth_flip::{Arm, Sight as ArmSight, octant};
use crate::finding::mean_and_error;
use crate::growth::{self, Growth};
use crate::quadrature::{Axis, integrate};
use sinew::core::combinators::Sum;
use sinew::core::density::{Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::toy::Quadratic;
use sinew::core::transition::{Cloud, Predict};
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::tracking::hmc_filter::{Config, HmcFilter};
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{Inferred, Tracker};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::PI;

/// A prior with a number of chains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// The prior.
    pub between: Between,
    /// Chains M: for the mixture the number of its components.
    pub chains: usize,
}

/// What is compared.
pub const SETTINGS: [Setting; 4] = [
    Setting { between: Between::Gaussian, chains: 16 },
    Setting { between: Between::Mixture, chains: 16 },
    Setting { between: Between::Mixture, chains: 250 },
    Setting { between: Between::Mixture, chains: 1000 },
];

impl Setting {
    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> String {
        match self.between {
            Between::Gaussian => format!("gaussian, {} chains", self.chains),
            Between::Mixture => format!("mixture, M = {}", self.chains),
        }
    }

    /// 25 kept draws a chain for the Gaussian prior, which all draws make; 13 for the mixture, which only last states make.
    #[must_use]
    pub fn config(self) -> Config {
        let (updates, burn_in) = if self.between == Between::Gaussian { (32, 8) } else { (16, 4) };
        Config {
            chains: self.chains,
            updates,
            burn_in,
            step_size: 0.5,
            leapfrog_steps: 4,
            jitter: 0.2,
            curvature_draws: 16,
            ..Config::default()
        }
    }
}

/// How long the random walk is followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Length {
    /// Independent series.
    pub runs: usize,
    /// Frames that only lead into the stationary state.
    pub before: usize,
    /// Frames that count.
    pub frames: usize,
}

/// A random walk x' = x + N(0, q² I) seen in all coordinates with errors N(0, r² I), by the HMC filter; each number with its standard error over series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Root mean square error of the mean in exact standard deviations.
    pub error: [f64; 2],
    /// Variance over the exact one.
    pub variance_ratio: [f64; 2],
    /// Exact probability of the 90 % intervals.
    pub covered: [f64; 2],
    /// Part of true coordinates in the 90 % intervals.
    pub covers_truth: [f64; 2],
    /// Part of the frames with a split R̂ above 1.05, or none.
    pub poorly_mixed: f64,
}

fn normals(count: usize, rng: &mut BlockRng) -> Vec<f64> {
    let mut blocks = vec![Block::ZERO; count.div_ceil(8)];
    rng.fill_normal(Isa::baseline(), &mut blocks);
    blocks.iter().flat_map(|b| b.0).take(count).collect()
}

/// 5 % and 95 % quantiles of a coordinate of equally weighted draws.
fn interval(posterior: &Posterior<'_>, coordinate: usize) -> [f64; 2] {
    let mut values: Vec<f64> =
        (0..posterior.count()).map(|i| posterior.states[i / 8 * posterior.dim + coordinate].0[i % 8]).collect();
    values.sort_by(f64::total_cmp);
    [0.05, 0.95].map(|p| {
        let place = p * (values.len() - 1) as f64;
        let below = place.floor() as usize;
        let above = (below + 1).min(values.len() - 1);
        values[below] + (place - below as f64) * (values[above] - values[below])
    })
}

/// Measures a setting at a ratio q / r in `dim` dimensions.
///
/// # Panics
/// Where a frame has no posterior.
#[must_use]
pub fn random_walk(setting: Setting, ratio: f64, dim: usize, length: Length, seed: u64) -> Calibration {
    let walk = Walk { between: setting.between, step: ratio, precision: vec![1.0; dim] };
    walk.calibration(&setting.config(), length, &Stage::new(seed, "filter priors").round(dim))
}

/// Measures the HMC filter with the settings of real recordings (no patience) that keep `draws` draws a frame, at q = 0.1 r; where the coordinates are seen `unlike`ly, r is 3.2 in the first, 0.1 in the last and between them in equal ratios, otherwise 1.
///
/// # Panics
/// Where a frame has no posterior.
#[must_use]
pub fn few_draws(draws: usize, unlike: bool, dim: usize, length: Length, seed: u64) -> Calibration {
    let real = Config::real_recordings();
    let updates = draws / real.chains + real.burn_in - 1;
    let place = |j: usize| if unlike { -1.0 + 3.0 * j as f64 / (dim - 1) as f64 } else { 0.0 };
    let precision = (0..dim).map(|j| 10.0_f64.powf(place(j))).collect();
    let walk = Walk { between: Between::Gaussian, step: 0.1, precision };
    walk.calibration(&Config { patience: 1, updates, ..real }, length, &Stage::new(seed, "few draws").round(dim))
}

/// A random walk with the precision of each coordinate's observation.
struct Walk {
    between: Between,
    step: f64,
    precision: Vec<f64>,
}

/// The exact filter of a [`Walk`], a scalar Kalman filter for each coordinate.
struct Exact {
    mean: Vec<f64>,
    variance: Vec<f64>,
}

impl Exact {
    fn step(&mut self, noise: f64, seen: &[f64], precision: &[f64]) {
        for (((m, v), z), p) in self.mean.iter_mut().zip(&mut self.variance).zip(seen).zip(precision) {
            *v += noise;
            let gain = *v / (*v + 1.0 / p);
            *m += gain * (z - *m);
            *v *= 1.0 - gain;
        }
    }
}

impl Walk {
    fn calibration(&self, config: &Config, length: Length, root: &Stage) -> Calibration {
        let mut all_runs: [Vec<f64>; 4] = Default::default();
        let mut mixed = 0;
        for r in 0..length.runs {
            let (sums, unmixed) = self.series(config, length, root.round(r));
            mixed += unmixed;
            all_runs.iter_mut().zip(sums).for_each(|(all, sum)| all.push(sum));
        }
        let [square, variance_ratio, covered, covers_truth] = all_runs.map(|values| mean_and_error(&values));
        let error = square[0].sqrt();
        Calibration {
            error: [error, 0.5 * square[1] / error],
            variance_ratio,
            covered,
            covers_truth,
            poorly_mixed: mixed as f64 / (length.runs * length.frames) as f64,
        }
    }

    /// One series: means of squared error, variance ratio, probability of the interval and truth in it; frames whose chains disagree.
    fn series(&self, config: &Config, length: Length, stage: Stage) -> ([f64; 4], usize) {
        let (isa, dim, unit) = (Isa::best(), self.precision.len(), Normal::standard());
        let [to_simulate, to_filter] = stage.split(["simulate", "filter"]);
        let walk = RandomWalk::new(&vec![self.step; dim], 1.0, self.between, isa)
            .and_then(|walk| walk.with_initial_sd(vec![1.0; dim]))
            .expect("positive");
        let mut filter = HmcFilter::new(config.clone(), walk, vec![0.0; dim], isa).expect("valid");
        let mut rng = to_simulate.whole();
        let mut truth = normals(dim, &mut rng);
        let mut exact = Exact { mean: vec![0.0; dim], variance: vec![1.0; dim] };
        let (mut sums, mut mixed) = ([0.0; 4], 0);
        for frame in 0..length.before + length.frames {
            let step = if frame > 0 { self.step } else { 0.0 };
            if frame > 0 {
                truth.iter_mut().zip(normals(dim, &mut rng)).for_each(|(x, z)| *x += step * z);
            }
            let errors = normals(dim, &mut rng).into_iter().zip(&self.precision).map(|(z, p)| z / p.sqrt());
            let seen: Vec<f64> = truth.iter().zip(errors).map(|(x, e)| x + e).collect();
            exact.step(step * step, &seen, &self.precision);
            let observed = Lanes { leaf: Quadratic { centre: seen, precision: self.precision.clone() }, isa };
            let info = filter.step(&observed, to_filter.round(frame)).expect("posterior");
            if frame < length.before {
                continue;
            }
            mixed += usize::from(info.r_hat.is_none_or(|r| r > 1.05));
            let posterior = filter.posterior();
            let moments = posterior.moments(isa);
            for (j, truth) in truth.iter().enumerate() {
                let (mean, variance) = (exact.mean[j], exact.variance[j]);
                let [low, high] = interval(&posterior, j);
                let at = |x: f64| unit.cdf((x - mean) / variance.sqrt());
                let values = [
                    (info.mean[j] - mean).powi(2) / variance,
                    moments.covariance[j * (dim + 1)] / variance,
                    at(high) - at(low),
                    f64::from(u8::from((low..=high).contains(truth))),
                ];
                sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value / (dim * length.frames) as f64);
            }
        }
        (sums, mixed)
    }
}

/// What a setting makes of the growth model: mean and standard error over runs of the error of P(x > 0), mean and standard deviation of the error of log Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnGrowth {
    /// Mean over frames of |P(x > 0) − exact|.
    pub sign: [f64; 2],
    /// Largest of them, mean over runs.
    pub worst_sign: f64,
    /// log Ẑ − log Z: mean and standard deviation.
    pub log_evidence: [f64; 2],
}

/// Summary of runs on the growth model.
#[must_use]
pub fn growth_model(runs: usize, run: impl Fn(usize) -> growth::Followed) -> OnGrowth {
    let found: Vec<growth::Followed> = (0..runs).map(run).collect();
    let of = |value: fn(&growth::Followed) -> f64| mean_and_error(&found.iter().map(value).collect::<Vec<_>>());
    let [mean, error] = of(|f| f.log_evidence);
    OnGrowth {
        sign: of(|f| f.sign),
        worst_sign: of(|f| f.worst_sign)[0],
        log_evidence: [mean, error * (runs as f64).sqrt()],
    }
}

/// Runs a setting on the growth model.
#[must_use]
pub fn on_growth(growth: &Growth, setting: Setting, runs: usize, seed: u64) -> OnGrowth {
    let root = Stage::new(seed, "filter priors, growth");
    growth_model(runs, |r| growth::by_chains(growth, setting.between, setting.chains, &root.round(r)))
}

/// Standard deviation of a frame's step of the arm's angles.
pub const ARM_WALK: f64 = 0.1;

/// The arm over several frames: its angles walk, and the exact masses of the eight modes are known in each.
#[derive(Clone, Debug)]
pub struct ArmSeries {
    arm: Arm,
    sights: Vec<ArmSight>,
    /// Exact mass of each mode in each frame.
    pub masses: Vec<[f64; 8]>,
}

impl ArmSeries {
    /// The stored arm and observation, then `frames` − 1 simulated ones; exact by a grid of `points` steps an angle.
    #[must_use]
    pub fn new(arm: &Arm, frames: usize, points: usize, seed: u64) -> Self {
        let mut rng = Stage::new(seed, "arm series").whole();
        let mut truth = arm.truth.clone();
        let mut sights = vec![arm.sight.clone()];
        for _ in 1..frames {
            truth.iter_mut().zip(normals(3, &mut rng)).for_each(|(x, z)| *x += ARM_WALK * z);
            let noise = normals(3, &mut rng);
            let mut end = 0.0;
            let y = (0..3)
                .map(|j| {
                    end += arm.sight.lengths[j] * truth[j].cos();
                    end + arm.sight.sigma * noise[j]
                })
                .collect();
            sights.push(ArmSight { y, ..arm.sight.clone() });
        }
        let masses = grid_masses(arm, &sights, points);
        Self { arm: arm.clone(), sights, masses }
    }

    /// Largest error of a mode's mass in each frame.
    ///
    /// # Panics
    /// Where a frame has no posterior.
    #[must_use]
    pub fn errors(&self, setting: Setting, stage: &Stage) -> Vec<f64> {
        let isa = Isa::best();
        let walk = RandomWalk::new(&[ARM_WALK; 3], 1.0, setting.between, isa)
            .and_then(|walk| walk.with_initial_sd(self.arm.sd.clone()))
            .expect("positive");
        let mut filter = HmcFilter::new(setting.config(), walk, self.arm.centre.clone(), isa).expect("valid");
        let mut errors = vec![];
        for (frame, sight) in self.sights.iter().enumerate() {
            filter.step(sight, stage.round(frame)).expect("posterior");
            let posterior = filter.posterior();
            let mut masses = [0.0; 8];
            let mut state = [0.0; 3];
            for (i, w) in posterior.weights.iter().enumerate() {
                posterior.state(i, &mut state);
                masses[octant(&state)] += w;
            }
            let off = masses.iter().zip(&self.masses[frame]).map(|(a, b)| (a - b).abs());
            errors.push(off.fold(0.0, f64::max));
        }
        errors
    }
}

/// The exact filter of the arm on the midpoints of `points` equal parts of (−π, π) for each angle.
fn grid_masses(arm: &Arm, sights: &[ArmSight], points: usize) -> Vec<[f64; 8]> {
    let n = points;
    let width = 2.0 * PI / n as f64;
    let node = |k: usize| -PI + width * (k as f64 + 0.5);
    let angles = |index: usize| [node(index / (n * n)), node(index / n % n), node(index % n)];
    let prior = arm.prior();
    let kernel: Vec<f64> = (0..n * n)
        .map(|e| {
            (-0.5 * ((node(e / n) - node(e % n)) / ARM_WALK).powi(2)).exp() * width / (ARM_WALK * (2.0 * PI).sqrt())
        })
        .collect();
    let mut mass: Vec<f64> = (0..n * n * n).map(|i| prior.log_density(&angles(i)).exp()).collect();
    let mut out = vec![];
    for (frame, sight) in sights.iter().enumerate() {
        if frame > 0 {
            // One angle after the other; each turn brings the last angle to the front.
            for _ in 0..3 {
                let mut moved = vec![0.0; mass.len()];
                for (line, values) in mass.chunks_exact(n).enumerate() {
                    for (to, row) in kernel.chunks_exact(n).enumerate() {
                        moved[to * n * n + line] = row.iter().zip(values).map(|(k, m)| k * m).sum();
                    }
                }
                mass = moved;
            }
        }
        mass.iter_mut().enumerate().for_each(|(i, m)| *m *= sight.log_density(&angles(i)).exp());
        let total: f64 = mass.iter().sum();
        let mut masses = [0.0; 8];
        for (i, m) in mass.iter_mut().enumerate() {
            *m /= total;
            masses[octant(&angles(i))] += *m;
        }
        out.push(masses);
    }
    out
}

/// Errors of the masses over runs: in the first frame, and in the mean of the later ones, with standard errors; and the largest of all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnArm {
    /// First frame: prior of the angles, no prior between frames yet.
    pub first: [f64; 2],
    /// Mean of the later frames.
    pub later: [f64; 2],
    /// Largest error of a mode's mass in any frame and run.
    pub worst: f64,
}

/// Runs a setting on the arm.
#[must_use]
pub fn on_arm(series: &ArmSeries, setting: Setting, runs: usize, seed: u64) -> OnArm {
    let root = Stage::new(seed, "filter priors, arm");
    let found: Vec<Vec<f64>> = (0..runs).map(|r| series.errors(setting, &root.round(r))).collect();
    let later = |errors: &Vec<f64>| errors[1..].iter().sum::<f64>() / (errors.len() - 1) as f64;
    OnArm {
        first: mean_and_error(&found.iter().map(|e| e[0]).collect::<Vec<_>>()),
        later: mean_and_error(&found.iter().map(later).collect::<Vec<_>>()),
        worst: found.iter().flatten().copied().fold(0.0, f64::max),
    }
}

/// What the arm's modes are under the Gaussian prior of its moments, exactly: the bias of `gaussian` that no number of draws removes. Largest error of a mode's mass in each frame after the first.
#[must_use]
pub fn gaussian_bias(series: &ArmSeries, parts: usize) -> Vec<f64> {
    let walk = RandomWalk::new(&[ARM_WALK; 3], 1.0, Between::Gaussian, Isa::best()).expect("positive");
    let axis = Axis::new(&[-PI, 0.0, PI], parts);
    let axes = [axis.clone(), axis.clone(), axis];
    let mut exact = integrate(&Sum(&series.sights[0], &series.arm.prior()), &axes, 8, octant);
    let mut errors = vec![];
    for (sight, masses) in series.sights.iter().zip(&series.masses).skip(1) {
        let cloud = Cloud { last: &[], count: 0, moments: &exact.moments };
        let prior = walk.predict(cloud).expect("positive definite");
        exact = integrate(&Sum(sight, &prior), &axes, 8, octant);
        errors.push(exact.masses.iter().zip(masses).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid's first frame is the static posterior, and a finer grid says the same.
    #[test]
    fn the_grid_filter_of_the_arm_converges() {
        let Some(arm) = Arm::stored() else { return };
        let [coarse, fine] = [48, 64].map(|points| ArmSeries::new(&arm, 2, points, 1).masses);
        for mode in 0..8 {
            assert!((fine[0][mode] - arm.masses[mode]).abs() < 2e-3, "{} against {}", fine[0][mode], arm.masses[mode]);
            assert!((coarse[1][mode] - fine[1][mode]).abs() < 4e-3, "{} against {}", coarse[1][mode], fine[1][mode]);
        }
    }

    /// With the prior that is exact in a linear model, few frames and chains: 90 % of the exact posterior in the intervals, to 3 %.
    #[test]
    fn the_gaussian_prior_is_calibrated_on_a_random_walk() {
        let length = Length { runs: 6, before: 5, frames: 8 };
        let found = random_walk(SETTINGS[0], 0.3, 4, length, 1);
        assert!((found.covered[0] - 0.9).abs() < 0.03, "{found:?}");
        assert!((found.variance_ratio[0] - 1.0).abs() < 0.1, "{found:?}");
    }

    /// 90 % of the exact posterior in the intervals, to 1 % and the noise of few series: without the widening of the prior 82 %.
    #[test]
    fn few_draws_in_many_dimensions_are_calibrated() {
        let found = few_draws(400, true, 28, Length { runs: 4, before: 20, frames: 20 }, 1);
        assert!((found.covered[0] - 0.9).abs() < 0.02, "{found:?}");
    }
}
