//! The samplers of the workspace as kernels of `sinew-invariance`.
//!
//! A kernel's state holds the states of eight chains, one after the other, since a block moves them together.

use sinew::core::density::GradLogDensity;
use sinew::core::lanes::{Block, LANES, get_lane, set_lane};
use sinew::core::random::BlockRng;
use sinew::samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew::samplers::jumps::{JumpWorkspace, Jumps, jump};
use sinew::samplers::nuts::{Nuts, Trees, step};
use sinew_invariance::targets::ExactTarget;

/// Eight states of `dim` coordinates as a block.
#[must_use]
pub fn to_block(states: &[f64], dim: usize) -> Vec<Block> {
    let mut block = vec![Block::ZERO; dim];
    states.chunks_exact(dim).enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
    block
}

/// The eight states of a block.
#[must_use]
pub fn from_block(block: &[Block]) -> Vec<f64> {
    let mut states = vec![0.0; block.len() * LANES];
    states.chunks_exact_mut(block.len()).enumerate().for_each(|(lane, state)| get_lane(block, lane, state));
    states
}

/// Eight independent draws, one after the other.
pub fn eight<T: ExactTarget + ?Sized>(target: &T) -> impl FnMut(&mut BlockRng) -> Vec<f64> + '_ {
    move |rng| (0..LANES).flat_map(|_| target.draw(rng)).collect()
}

/// One trajectory of Hamiltonian Monte Carlo for each of eight states.
///
/// # Panics
/// At states of no density, which are no starts.
pub fn hmc<T: GradLogDensity>(target: &T, hmc: Hmc) -> impl FnMut(&[f64], &mut BlockRng) -> Vec<f64> + '_ {
    let mut ws = Workspace::new(target);
    move |states, rng| {
        let mut chains = Chains::new(target, to_block(states, target.dim())).expect("starts with a density");
        update(target, &hmc, &mut chains, &mut ws, rng);
        from_block(&chains.position)
    }
}

/// One transition of the no-U-turn sampler for each of eight states.
///
/// # Panics
/// At states of no density.
pub fn nuts<T: GradLogDensity>(target: &T, nuts: Nuts) -> impl FnMut(&[f64], &mut BlockRng) -> Vec<f64> + '_ {
    move |states, rng| {
        let mut trees = Trees::new(target, &nuts, to_block(states, target.dim())).expect("starts with a density");
        let mut active = [true; LANES];
        while active.contains(&true) {
            let complete = step(target, &nuts, &mut trees, &active, rng);
            active.iter_mut().zip(complete).for_each(|(active, complete)| *active &= complete.is_none());
        }
        from_block(trees.position())
    }
}

/// `jumps.count` proposals from a fixed mixture for each of eight states.
///
/// # Panics
/// At states of no density.
pub fn jumps<T: GradLogDensity>(target: &T, jumps: Jumps) -> impl FnMut(&[f64], &mut BlockRng) -> Vec<f64> + '_ {
    let mut ws = JumpWorkspace::new(target, &jumps);
    let mut scratch = jumps.proposal.scratch();
    move |states, rng| {
        let mut chains = Chains::new(target, to_block(states, target.dim())).expect("starts with a density");
        let mut log_weight = jumps.proposal.log_density_block(&chains.position, &mut scratch);
        log_weight.0.iter_mut().zip(chains.log_density.0).for_each(|(w, p)| *w = p - *w);
        for _ in 0..jumps.count {
            jump(target, &jumps.proposal, &mut chains, LANES, &mut log_weight, &mut ws, rng);
        }
        from_block(&chains.position)
    }
}
