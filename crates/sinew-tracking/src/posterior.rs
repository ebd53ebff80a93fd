//! Draws of one frame's posterior, as every tracker leaves them.

use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;
use sinew_core::transition::Moments;
use sinew_samplers::moments;
use sinew_samplers::resample::{Ancestors, systematic};

pub use sinew_samplers::chains::ChainStat;

/// Weighted draws of one frame's posterior, borrowed from the tracker. State i is lane i mod 8 of block i / 8; lanes beyond the count mean nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posterior<'a> {
    /// Dimension of the state.
    pub dim: usize,
    /// The states, blocks of `dim` [`Block`]s.
    pub states: &'a [Block],
    /// Normalised weights, one a draw; all equal for chains.
    pub weights: &'a [f64],
    /// Number of independent draws that they are worth for second moments.
    pub effective: f64,
    /// One entry a draw from the Hamiltonian updates that made them; empty for particle methods.
    pub chain_stats: &'a [ChainStat],
}

impl Posterior<'_> {
    /// Number of draws.
    #[must_use]
    pub fn count(&self) -> usize {
        self.weights.len()
    }

    /// Copies draw `index` out.
    pub fn state(&self, index: usize, out: &mut [f64]) {
        let block = &self.states[index / LANES * self.dim..];
        for (x, b) in out.iter_mut().zip(block) {
            *x = b.0[index % LANES];
        }
    }

    /// Weighted mean.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        moments::mean(self.states, self.dim, self.weights)
    }

    /// Mean and covariance.
    #[must_use]
    pub fn moments(&self, isa: Isa) -> Moments {
        moments::moments(isa, self.states, self.dim, self.weights, self.effective)
    }

    /// Indices of `n` equally weighted draws, by one systematic resampling.
    #[must_use]
    pub fn equal_weight(&self, n: usize, rng: &mut BlockRng) -> Ancestors {
        systematic(self.weights, n, rng)
    }
}
