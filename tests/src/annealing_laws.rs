//! Annealing against its laws: noise of layers, marginals under crossover, collapse on eight modes.
//!
//! These are A6, A11 and the second half of E7.

use crate::depth_flip::{Arm, octant};
use crate::finding::{Finding, mean_and_error};
use crate::size::Size;
use sinew::core::density::LogDensity;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::samplers::annealed_search::{self, Scaling};
use sinew::samplers::crossover::cross;
use sinew::samplers::diffusion::diffuse;
use sinew::samplers::particles::{Particles, resample, reweight};
use sinew::samplers::resample::Scheme;
use sinew::tracking::Tracker;
use sinew::tracking::annealed::{Annealed, Config};
use sinew::tracking::bootstrap::{self, Bootstrap};

/// Noise of layers (A6): the covariance of 10⁵ draws of the noise after v weightings is α^v P, within 2 % (4.5 standard deviations of a variance); with deviations scaled, α^(2v) P.
///
/// # Panics
/// Never: the settings are valid.
#[must_use]
pub fn noise_of_layers(seed: u64) -> Vec<Finding> {
    let sd = [0.5, 2.0, 0.03];
    let count = 100_000;
    let mut findings = vec![];
    for (scaling, power) in [(Scaling::Variance, 1), (Scaling::StandardDeviation, 2)] {
        let config = annealed_search::Config { survival: 0.6, scaling, ..Default::default() };
        for weightings in [0, 1, 4] {
            let mut particles = Particles::new(&[1.0, 2.0, 3.0], count).expect("not empty");
            let stage = Stage::new(seed, "A6").round(weightings);
            diffuse(&mut particles, None, &config.noise(&sd, weightings), Isa::best(), stage);
            let mut worst: f64 = 0.0;
            for i in 0..3 {
                for j in 0..=i {
                    let product = |k: usize| {
                        let x = particles.state(k);
                        (x[i] - [1.0, 2.0, 3.0][i]) * (x[j] - [1.0, 2.0, 3.0][j]) / (sd[i] * sd[j])
                    };
                    let found = (0..count).map(product).sum::<f64>() / count as f64;
                    let scale = 0.6_f64.powi(power * weightings as i32);
                    worst = worst.max((found / scale - f64::from(u8::from(i == j))).abs());
                }
            }
            let name = format!("noise after {weightings} weightings, {scaling:?}: relative error of its covariance");
            findings.push(Finding::at_most(name, worst, 0.02, format!("{count} draws, seed {seed}")));
        }
    }
    findings
}

/// Weights of some slope.
struct Slope;
impl LogDensity for Slope {
    fn dim(&self) -> usize {
        4
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        x[0] + 0.5 * x[1] * x[2] - 0.3 * x[3]
    }
}

/// Crossover keeps the marginals (A11): mean and square of each coordinate over crossed children equal the weighted set's; the product of two coordinates is not, or nothing was crossed. 10⁵ children, 8 scores at |z| < 4.5.
///
/// # Panics
/// Never: no weight is zero.
#[must_use]
pub fn marginals_under_crossover(seed: u64, size: Size) -> Vec<Finding> {
    let [to_draw, to_resample, to_cross] = Stage::new(seed, "A11").split(["draw", "resample", "cross"]);
    let mut before = Particles::new(&[0.0; 4], 500).expect("not empty");
    diffuse(&mut before, None, &[1.0; 4], Isa::best(), to_draw);
    reweight(&mut before, &Slope).expect("weights");
    let mean = |particles: &Particles, f: &dyn Fn(&[f64]) -> f64| -> f64 {
        particles.weights().iter().enumerate().map(|(i, w)| w * f(&particles.state(i))).sum()
    };
    let replicates: Vec<Particles> = (0..size.pick(200, 2000))
        .map(|replicate| {
            let mut children = before.clone();
            let ancestors = resample(&children, Scheme::Multinomial, to_resample.round(replicate));
            cross(&mut children, ancestors, 0.5, to_cross.round(replicate));
            children
        })
        .collect();
    let score = |name: String, f: &dyn Fn(&[f64]) -> f64| {
        let exact = mean(&before, f);
        let [found, error] = mean_and_error(&replicates.iter().map(|r| mean(r, f)).collect::<Vec<_>>());
        let detail =
            format!("{found:.4} ± {error:.4} for {exact:.4}, {} × 500 children, seed {seed}", replicates.len());
        Finding::score(name, (found - exact) / error, 4.5, detail)
    };
    let mut findings: Vec<Finding> = (0..4)
        .flat_map(|j| {
            [
                score(format!("crossover: mean {j}"), &|x| x[j]),
                score(format!("crossover: square {j}"), &|x| x[j] * x[j]),
            ]
        })
        .collect();
    let product = score("crossover: product of coordinates 1 and 2".into(), &|x| x[1] * x[2]);
    let changed = format!("correlations change: |z| of {}", product.name);
    let bounds = [4.5, f64::INFINITY];
    findings.push(Finding::between(changed, product.statistic.abs(), bounds, product.detail));
    findings
}

/// Collapse on eight modes (second half of E7): an arm that rests for 20 frames, the last exponent left free. What is seen never shows the signs, so a posterior keeps its modes; the annealed filter, 10 layers of 200, must have lost half of
/// the eight on average. A bootstrap filter with as many evaluations a frame must not. In the first frame alone the annealed filter, with 2000 particles, still stands at seven or eight modes, with masses off by 0.05
/// to 0.14.
///
/// # Panics
/// When all weights are zero, which would be a defect.
#[must_use]
pub fn collapse_on_the_depth_flip(arm: &Arm, runs: usize, seed: u64) -> Vec<Finding> {
    let walk = || {
        let walk = RandomWalk::new(&[0.1; 3], 1.0, Between::Mixture, Isa::best()).expect("valid");
        walk.with_initial_sd(arm.sd.clone()).expect("valid")
    };
    let modes = |particles: &Particles| {
        let mut masses = [0.0; 8];
        particles.weights().iter().enumerate().for_each(|(i, w)| masses[octant(&particles.state(i))] += w);
        masses.iter().filter(|mass| **mass > 0.01).count()
    };
    let (mut annealed, mut filtered) = (vec![], vec![]);
    for run in 0..runs {
        let stage = |frame: u32| Stage::new(seed, "collapse").round(run).at_frame(frame);
        let tracker = Annealed::new(Config::default(), walk(), vec![0.1; 3], arm.centre.clone(), Isa::best());
        let mut tracker = tracker.expect("valid");
        let config = bootstrap::Config { particles: 2000, ..bootstrap::Config::default() };
        let mut filter = Bootstrap::new(config, walk(), arm.centre.clone()).expect("valid");
        for frame in 0..20 {
            tracker.step(&arm.sight, stage(frame)).expect("weights");
            filter.step(&arm.sight, stage(frame)).expect("weights");
        }
        annealed.push(modes(tracker.particles()));
        filtered.push(modes(filter.particles()));
    }
    let finding = |name: &str, modes: &[usize], bounds| {
        let mean = modes.iter().sum::<usize>() as f64 / runs as f64;
        Finding::between(name, mean, bounds, format!("{runs} runs, seed {seed}; {modes:?}"))
    };
    vec![
        finding("modes of the depth flip that the annealed filter keeps for 20 frames", &annealed, [1.0, 4.0]),
        finding("modes of the depth flip that the bootstrap filter keeps for 20 frames", &filtered, [4.0, 8.0]),
    ]
}
