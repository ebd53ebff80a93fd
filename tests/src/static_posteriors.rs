//! Samplers of one frame against exact answers.
//!
//! Tempered sequential Monte Carlo on eight modes (E7), the volume law of particles (E8, E9), Hamiltonian Monte Carlo on the camera point.

use crate::camera_point::CameraPoint;
use crate::depth_flip::{Arm, octant};
use crate::finding::Finding;
use sinew::core::density::{Lanes, LogDensity};
use sinew::core::diagnostics::effective_sample_size;
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::toy::Quadratic;
use sinew::core::transition::{MotionModel, Transition};
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::curvature::curvature;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::metric::{Dense, Metric};
use sinew::samplers::tempered_smc::{Config, temper};
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};

/// Tempered sequential Monte Carlo on eight modes (E7): evidence within 0.2, the mass of each mode within 0.06 at N = 2000, in each of `runs` runs.
#[must_use]
pub fn tempered_depth_flip(arm: &Arm, particles: usize, runs: usize, seed: u64) -> Vec<Finding> {
    let prior = arm.prior();
    let root = Stage::new(seed, "depth flip");
    let (mut off, mut worst) = (vec![], vec![]);
    for r in 0..runs {
        let [to_average, to_sample] = root.round(r).split(["curvature", "sample"]);
        let metric = Metric::Diagonal(curvature(&arm.sight, &prior, 64, to_average));
        let config = Config { particles, updates: 4, step_size: 0.6, leapfrog_steps: 6, ..Config::default() };
        let run = temper(&arm.sight, &prior, &metric, &config, Isa::best(), to_sample).expect("runs");
        off.push(run.log_evidence - arm.log_evidence);
        let mut masses = [0.0; 8];
        let share = 1.0 / (run.draws.len() * particles) as f64;
        for draws in &run.draws {
            (0..particles).for_each(|i| masses[octant(&draws.state(i))] += share);
        }
        worst.push(masses.iter().zip(&arm.masses).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max));
    }
    let largest = |values: &[f64]| values.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let of = format!("N = {particles}, {runs} runs, seed {seed}");
    vec![
        Finding::at_most(
            "tempered SMC on the depth flip: error of log Z",
            largest(&off),
            0.2,
            format!("{of}; {off:.3?}"),
        ),
        Finding::at_most(
            "tempered SMC on the depth flip: error of a mode's mass",
            largest(&worst),
            0.06,
            format!("{of}; {worst:.3?}"),
        ),
    ]
}

/// Draws of a box around 0.
struct BoxPrior(Vec<f64>);

impl MotionModel for BoxPrior {
    fn dim(&self) -> usize {
        self.0.len()
    }
}

impl Transition for BoxPrior {
    fn sample_block(&self, _previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_uniform(next);
        for (x, half) in next.iter_mut().zip(&self.0) {
            x.0.iter_mut().for_each(|x| *x = half * (2.0 * *x - 1.0));
        }
    }
    fn log_density(&self, _previous: &[f64], next: &[f64]) -> f64 {
        let inside = next.iter().zip(&self.0).all(|(x, half)| x.abs() <= *half);
        if inside { -self.0.iter().map(|half| (2.0 * half).ln()).sum::<f64>() } else { f64::NEG_INFINITY }
    }
}

/// 0 inside a box around 0, −∞ outside.
struct Inside(Vec<f64>);

impl LogDensity for Inside {
    fn dim(&self) -> usize {
        self.0.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x.iter().zip(&self.0).all(|(x, half)| x.abs() <= *half) { 0.0 } else { f64::NEG_INFINITY }
    }
}

/// Volume law of boxes (E8): with a prior uniform on a box and a posterior uniform on a smaller one, the variance of the particle mean is (ratio of volumes) / N · variance of the posterior.
#[must_use]
pub fn volume_law(particles: usize, runs: usize, seed: u64) -> Vec<Finding> {
    let (prior, posterior) = (vec![1.0, 2.0], vec![0.5, 0.4]);
    let ratio: f64 = prior.iter().zip(&posterior).map(|(a, b)| a / b).product();
    let mut squares = [0.0; 2];
    for r in 0..runs {
        let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
        let mut filter = Bootstrap::new(config, BoxPrior(prior.clone()), vec![0.0; 2]).expect("valid");
        let stage = Stage::new(seed, "volume law").round(r);
        let info = filter.step(&Inside(posterior.clone()), stage).expect("some are inside");
        squares.iter_mut().zip(&info.mean).for_each(|(s, m)| *s += m * m / runs as f64);
    }
    (0..2)
        .map(|j| {
            let law = ratio / particles as f64 * posterior[j] * posterior[j] / 3.0;
            let detail = format!("N = {particles}, ratio of volumes {ratio}, {runs} runs, seed {seed}");
            Finding::between(
                format!("variance of the particle mean over the volume law, axis {j}"),
                squares[j] / law,
                [0.9, 1.1],
                detail,
            )
        })
        .collect()
}

/// N(0, I).
struct Standard(usize);

impl MotionModel for Standard {
    fn dim(&self) -> usize {
        self.0
    }
}

impl Transition for Standard {
    fn sample_block(&self, _previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::best(), next);
    }
    fn log_density(&self, _previous: &[f64], next: &[f64]) -> f64 {
        next.iter().map(|x| -0.5 * x * x - 0.5 * std::f64::consts::TAU.ln()).sum()
    }
}

/// Volume law of Gaussians (E9): prior N(0, I), posterior standard deviations s about the same centre: N / N_eff = Π 1 / (s_j √(2 − s_j²)), to 5 %.
#[must_use]
pub fn gaussian_volume_law(particles: usize, seed: u64) -> Vec<Finding> {
    [vec![0.3], vec![0.3, 0.8], vec![0.4, 0.5, 0.6, 0.9]]
        .into_iter()
        .map(|s| {
            let d = s.len();
            let law: f64 = s.iter().map(|s: &f64| 1.0 / (s * (2.0 - s * s).sqrt())).product();
            let precision = s.iter().map(|s| 1.0 / (s * s) - 1.0).collect();
            let seen = Lanes { leaf: Quadratic { centre: vec![0.0; d], precision }, isa: Isa::best() };
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            let mut filter = Bootstrap::new(config, Standard(d), vec![0.0; d]).expect("valid");
            let info = filter.step(&seen, Stage::new(seed, "gaussian volume law").round(d)).expect("weights");
            let found = particles as f64 / info.ess / law;
            Finding::between(
                format!("N / N_eff over the law, s = {s:?}"),
                found,
                [0.95, 1.05],
                format!("N = {particles}, seed {seed}"),
            )
        })
        .collect()
}

/// `camera-point`: means of Hamiltonian Monte Carlo within four Monte Carlo errors, evidence apart.
///
/// # Panics
/// Where a start has no density.
#[must_use]
pub fn camera_point_chains(point: &CameraPoint, updates: usize, seed: u64) -> Vec<Finding> {
    let isa = Isa::best();
    let target = point.target();
    let mut precision = vec![0.0; 9];
    for j in 0..3 {
        precision[4 * j] = 1.0 / point.moments.covariance[4 * j];
    }
    let metric = Metric::Dense(Dense::new(&precision, 3).expect("positive definite"));
    let hmc = Hmc::with_metric(0.6, &metric, 4, 0.2, isa).expect("valid");
    let mut starts = vec![Block::ZERO; 2 * 3];
    Stage::new(seed, "camera point start").whole().fill_normal(isa, &mut starts);
    for state in starts.chunks_exact_mut(3) {
        for (j, x) in state.iter_mut().enumerate() {
            let sd = point.moments.covariance[4 * j].sqrt();
            x.0.iter_mut().for_each(|x| *x = point.mode[j] + 2.0 * sd * *x);
        }
    }
    let schedule = Schedule { updates, burn_in: 50 };
    let draws = draw_trajectories(&target, &hmc, &starts, 2 * LANES, schedule, &Stage::new(seed, "camera point"))
        .expect("finite");
    let mut findings: Vec<Finding> = vec![];
    let mut check = |name: String, values: Vec<Vec<f64>>, exact: f64| {
        let n = values.iter().map(Vec::len).sum::<usize>() as f64;
        let mean = values.iter().flatten().sum::<f64>() / n;
        let variance = values.iter().flatten().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
        let error = (variance / effective_sample_size(&values)).sqrt();
        let detail = format!("{mean:.6e} against {exact:.6e}, seed {seed}");
        findings.push(Finding::score(name, (mean - exact) / error, 4.0, detail));
    };
    for i in 0..3 {
        check(format!("camera point, mean {i}"), draws.series(i), point.moments.mean[i]);
        for j in 0..=i {
            let centred = |k: usize| -> Vec<Vec<f64>> {
                let mean = point.moments.mean[k];
                draws.series(k).into_iter().map(|c| c.into_iter().map(|x| x - mean).collect()).collect()
            };
            let product = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a * b).collect();
            let values = centred(i).iter().zip(&centred(j)).map(product).collect();
            check(format!("camera point, covariance {i} {j}"), values, point.moments.covariance[3 * i + j]);
        }
    }
    findings
}
