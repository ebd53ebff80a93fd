//! Markov kernels apart from the verbs that apply them.

use crate::random::BlockRng;

/// A kernel that moves one state.
pub trait MarkovKernel {
    /// Replaces `state` by a draw from the kernel.
    fn step(&mut self, state: &mut [f64], rng: &mut BlockRng);
}

/// Claims that a kernel leaves its target unchanged: a start drawn from the target ends as a draw from the target.
///
/// Annealing's diffusion and crossover make no such claim.
pub trait Invariant: MarkovKernel {}
