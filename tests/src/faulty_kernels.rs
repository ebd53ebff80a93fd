//! Kernels with faults that tests of invariance must see: steps from the state's own curvature (H7), and rejected states that are dropped (H10).

use crate::finding::{Finding, mean_and_error};
use crate::kernels::{self, eight, from_block, to_block};
use crate::sampler_invariance::plain;
use crate::size::Size;
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::samplers::hmc::{Chains, DIVERGENCE, Hmc, Workspace, update};
use sinew::samplers::integrator::PhasePoint;
use sinew_invariance::draws::{normals, uniforms};
use sinew_invariance::targets::ExactTarget;
use sinew_invariance::{ExactStart, Report, TestFunctions, exact_start};

/// Student's t with four degrees: far out its curvature is a fraction of that in the middle. Drawn as z √(2 / e) with e the sum of two exponential deviates.
#[derive(Clone, Copy)]
pub struct HeavyTails;

impl LogDensity for HeavyTails {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -2.5 * (x[0] * x[0] / 4.0).ln_1p()
    }
}

impl GradLogDensity for HeavyTails {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = -5.0 * x[0] / (4.0 + x[0] * x[0]);
        self.log_density(x)
    }
}

impl ExactTarget for HeavyTails {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        let chi_square = -2.0 * uniforms(2, rng).iter().map(|u| u.ln()).sum::<f64>();
        vec![normals(1, rng)[0] * (4.0 / chi_square).sqrt()]
    }
}

/// x² e^{−x} on the positive half-line, −∞ elsewhere: skewed, with mean and variance 3.
#[derive(Clone, Copy)]
pub struct Skewed;

impl LogDensity for Skewed {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        if x[0] > 0.0 { 2.0 * x[0].ln() - x[0] } else { f64::NEG_INFINITY }
    }
}

impl GradLogDensity for Skewed {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = 2.0 / x[0] - 1.0;
        self.log_density(x)
    }
}

impl ExactTarget for Skewed {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        vec![-uniforms(3, rng).iter().map(|u| u.ln()).sum::<f64>()]
    }
}

/// What the fault of the step sizes (H7) multiplies the steps with: the root of the inverse curvature of [`HeavyTails`] at the chain's own state.
fn faulty_factor(x: f64) -> f64 {
    (1.0 + x * x / 4.0).sqrt()
}

/// The update with that fault.
fn by_curvature_of_state(hmc: &Hmc) -> impl FnMut(&[f64], &mut BlockRng) -> Vec<f64> + '_ {
    move |states, rng| {
        let mut chains = Chains::new(&HeavyTails, to_block(states, 1)).expect("starts with a density");
        let (mut p, mut u) = ([Block::ZERO], [Block::ZERO]);
        rng.fill_normal(Isa::best(), &mut p);
        rng.fill_uniform(&mut u);
        let factor = Block(chains.position[0].0.map(faulty_factor));
        let (mut x, mut g) = (chains.position.clone(), chains.gradient.clone());
        let kinetic = p[0].0.map(|p| 0.5 * p * p);
        let point = PhasePoint { position: &mut x, momentum: &mut p, gradient: &mut g };
        let end = hmc.trajectory(&HeavyTails, &factor, point, &mut []);
        for (lane, kinetic) in kinetic.into_iter().enumerate() {
            let error = end.kinetic.0[lane] - end.log_density.0[lane] - kinetic + chains.log_density.0[lane];
            if error < DIVERGENCE && u[0].0[lane] < (-error).exp() {
                chains.position[0].0[lane] = x[0].0[lane];
            }
        }
        from_block(&chains.position)
    }
}

/// Fault of the step sizes (H7): on heavy tails the project's update keeps the target; the same update with steps from the curvature at the chain's state does not. Both reports, the right one first.
#[must_use]
pub fn curvature_of_state(seed: u64, size: Size) -> [Report; 2] {
    let config = ExactStart { starts: size.pick(6000, 25_000), seed, ..ExactStart::default() };
    // The square of a target with four degrees of freedom has no variance.
    let functions = || {
        TestFunctions::none()
            .with("|x|", |x| x[0].abs())
            .with("tail", |x| f64::from(u8::from(x[0].abs() > 3.0)))
            .together(LANES)
    };
    let hmc = plain(1, 0.8, 3, 0.0);
    let right = exact_start(&config, eight(&HeavyTails), kernels::hmc(&HeavyTails, hmc.clone()), &functions());
    let wrong = exact_start(&config, eight(&HeavyTails), by_curvature_of_state(&hmc), &functions());
    [right, wrong]
}

/// Fault of dropped rejections (H10): the mean of [`Skewed`] over all states, and over those only that a trajectory brought; and the part that was rejected. A kernel whose rejected states are dropped shows in the second.
#[must_use]
pub fn rejections(blocks: usize, updates: usize, seed: u64) -> [Finding; 3] {
    let hmc = Hmc::new(2.1, &[0.5], 1, 0.0, Isa::best()).expect("valid");
    let [to_start, to_move] = Stage::new(seed, "rejections").split(["start", "move"]);
    let starts =
        (0..blocks).map(|b| to_block(&eight(&Skewed)(&mut to_start.block(b as u32)), 1)[0]).collect::<Vec<_>>();
    let (mut all, mut dropped, mut rejected) = (vec![], vec![], 0);
    for (block, start) in starts.iter().enumerate() {
        let mut chains = Chains::new(&Skewed, vec![*start]).expect("finite");
        let mut ws = Workspace::new(&Skewed);
        let mut rng = to_move.block(block as u32);
        let (mut sums, mut taken) = ([0.0; LANES], [(0.0, 0.0); LANES]);
        for _ in 0..updates {
            let moved = update(&Skewed, &hmc, &mut chains, &mut ws, &mut rng);
            for lane in 0..LANES {
                let x = chains.position[0].0[lane];
                sums[lane] += x / updates as f64;
                if moved.accepted[lane] {
                    taken[lane].0 += x;
                    taken[lane].1 += 1.0;
                } else {
                    rejected += 1;
                }
            }
        }
        all.extend(sums);
        dropped.extend(taken.iter().filter(|t| t.1 > 0.0).map(|t| t.0 / t.1));
    }
    let part = rejected as f64 / (blocks * LANES * updates) as f64;
    let of = |what: &str, values: &[f64]| {
        let [mean, error] = mean_and_error(values);
        Finding::score(what, (mean - 3.0) / error, 4.5, format!("mean {mean:.4} ± {error:.4} for 3, seed {seed}"))
    };
    [
        of("mean of all states", &all),
        of("mean without rejected states", &dropped),
        Finding::between("part rejected", part, [0.4, 0.6], ""),
    ]
}

/// Fault of the step sizes (H7) by reversal: where a trajectory of the kernel with the fault comes out when it starts from its end with the momentum turned; the distance from its start, for both kernels.
#[must_use]
pub fn reversal() -> [f64; 2] {
    let hmc = Hmc::new(0.8, &[1.0], 3, 0.0, Isa::best()).expect("valid");
    let distance = |factor: &dyn Fn(f64) -> f64| {
        let (mut x, mut p) = ([Block::splat(1.5)], [Block::splat(0.7)]);
        for _ in 0..2 {
            let mut g = [Block::ZERO];
            HeavyTails.log_density_grad_block(&x, &mut g, &mut []);
            let factor = Block(x[0].0.map(factor));
            let point = PhasePoint { position: &mut x, momentum: &mut p, gradient: &mut g };
            hmc.trajectory(&HeavyTails, &factor, point, &mut []);
            p[0].0.iter_mut().for_each(|p| *p = -*p);
        }
        (x[0].0[0] - 1.5).abs()
    };
    [distance(&|_| 1.0), distance(&faulty_factor)]
}
