//! `target acceptance` and `adaptation-frozen`: what a tuned step size accepts, and that it does not change any more.

use crate::finding::Finding;
use sinew::core::density::Lanes;
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::dynamics::gaussian::Gaussian;
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew::samplers::metric::Metric;
use sinew::samplers::tuning::{self, StepSizeTrial};

/// A Gaussian whose covariance is Σ + 1 1ᵀ / 2 with variances Σ from 1 to `widest`.
fn correlated(dim: usize, widest: f64) -> Lanes<Gaussian> {
    let variance = |j: usize| widest.powf(j as f64 / (dim.max(2) - 1) as f64);
    let entry = |i: usize, j: usize| 0.5 + if i == j { variance(i) } else { 0.0 };
    let covariance: Vec<f64> = (0..dim * dim).map(|e| entry(e / dim, e % dim)).collect();
    let leaf = Gaussian::new(vec![0.0; dim], &covariance).expect("positive definite");
    Lanes { leaf, isa: Isa::best() }
}

/// `target acceptance` and `adaptation-frozen`: on 28 dimensions a step size is tuned to accept 0.8; then it accepts 0.8 ± 0.03, and the kept draws are bit for bit the draws of updates with that one step size and metric.
#[must_use]
pub fn tuned_acceptance(updates: usize, seed: u64) -> [Finding; 2] {
    let isa = Isa::best();
    let target = correlated(28, 8.0);
    let metric = Metric::Diagonal(target.leaf.precision_diagonal().to_vec());
    let [to_start, to_tune, to_move] = Stage::new(seed, "tuned").split(["start", "tune", "move"]);
    let mut states = vec![Block::ZERO; 2 * 28];
    for (block, states) in states.chunks_exact_mut(28).enumerate() {
        target.leaf.sample_block(isa, states, &mut to_start.block(block as u32));
    }
    let config = tuning::Config { acceptance: 0.8, tolerance: 0.01, trajectories: 4000, ..tuning::Config::default() };
    let mut trial = StepSizeTrial { target: &target, metric: &metric, states, isa };
    let tuned = tuning::step_size(&mut trial, 10, &config, &to_tune).expect("tunable");
    let hmc = Hmc::with_metric(tuned.step_size, &metric, 10, 0.0, isa).expect("valid");
    let schedule = Schedule { updates, burn_in: 0 };
    let draws = draw_trajectories(&target, &hmc, &trial.states, 16, schedule, &to_move).expect("finite");
    let frozen = hmc.clone();
    let mut different = 0;
    let series: Vec<Vec<Vec<f64>>> = (0..28).map(|j| draws.series(j)).collect();
    let kept = |coordinate: usize, chain: usize, k: usize| series[coordinate][chain][k];
    for (block, start) in trial.states.chunks_exact(28).enumerate() {
        let mut chains = Chains::new(&target, start.to_vec()).expect("finite");
        let (mut ws, mut rng) = (Workspace::new(&target), to_move.block(block as u32));
        for k in 1..=updates {
            update(&target, &frozen, &mut chains, &mut ws, &mut rng);
            for (j, x) in chains.position.iter().enumerate() {
                for lane in 0..LANES {
                    different += usize::from(x.0[lane].to_bits() != kept(j, block * LANES + lane, k).to_bits());
                }
            }
        }
    }
    different += draws.stats.iter().filter(|s| s.step_factor.to_bits() != 1.0_f64.to_bits()).count();
    let detail = format!("step size {:.3}, {} draws, seed {seed}", tuned.step_size, draws.stats.len());
    [
        Finding::between("realised acceptance", draws.acceptance, [0.77, 0.83], detail),
        Finding::at_most("kept numbers that another step size or metric made", different as f64, 0.0, "bit for bit"),
    ]
}
