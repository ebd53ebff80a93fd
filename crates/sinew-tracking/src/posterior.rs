//! Draws of one frame's posterior, as every tracker leaves them.

use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;
use sinew_core::transition::{Moments, Transition};
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

impl<'a> Posterior<'a> {
    /// The same draws as what they decode to; none where nothing has been decoded.
    pub(crate) fn as_poses(self, states: &'a [Block], dim: usize) -> Self {
        if states.is_empty() {
            return Self { dim, states: &[], weights: &[], effective: 0.0, chain_stats: &[] };
        }
        Self { dim, states, ..self }
    }

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

    /// Standard deviations of the coordinates about their mean, of as many independent draws as these are worth.
    #[must_use]
    pub fn sd(&self, mean: &[f64]) -> Vec<f64> {
        moments::standard_deviations(self.states, mean, self.weights, self.effective)
    }

    /// The draw of the largest weight.
    #[must_use]
    pub fn heaviest(&self) -> Vec<f64> {
        let by_weight = |(_, a): &(usize, &f64), (_, b): &(usize, &f64)| a.total_cmp(b);
        let index = self.weights.iter().enumerate().max_by(by_weight).map_or(0, |(index, _)| index);
        let mut state = vec![0.0; self.dim];
        self.state(index, &mut state);
        state
    }

    /// Log density of a next state under the transition from these draws, a mixture: log Σ W_i p(next | s_i). Of chains the last states count alone, one a chain, as the last `chains` draws hold them.
    #[must_use]
    pub fn predictive_log_density(&self, transition: &impl Transition, chains: usize, next: &[f64]) -> f64 {
        let count = self.count();
        let has_chains = !self.chain_stats.is_empty();
        let first = if has_chains { count.saturating_sub(chains) } else { 0 };
        let mut state = vec![0.0; self.dim];
        let terms: Vec<f64> = (first..count)
            .map(|i| {
                self.state(i, &mut state);
                let weight = if has_chains { 1.0 / chains as f64 } else { self.weights[i] };
                weight.ln() + transition.log_density(&state, next)
            })
            .collect();
        let largest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        largest + terms.iter().map(|t| (t - largest).exp()).sum::<f64>().ln()
    }

    /// Indices of `n` equally weighted draws, by one systematic resampling.
    #[must_use]
    pub fn equal_weight(&self, n: usize, rng: &mut BlockRng) -> Ancestors {
        systematic(self.weights, n, rng)
    }
}

/// A posterior that its tracker has left behind.
#[derive(Default)]
pub(crate) struct Copied {
    dim: usize,
    states: Vec<Block>,
    weights: Vec<f64>,
    effective: f64,
    chain_stats: Vec<ChainStat>,
}

impl Copied {
    pub(crate) fn take(&mut self, posterior: Posterior<'_>) {
        let Posterior { dim, states, weights, effective, chain_stats } = posterior;
        (self.dim, self.effective) = (dim, effective);
        states.clone_into(&mut self.states);
        weights.clone_into(&mut self.weights);
        chain_stats.clone_into(&mut self.chain_stats);
    }

    pub(crate) fn view(&self) -> Posterior<'_> {
        let Self { dim, states, weights, effective, chain_stats } = self;
        Posterior { dim: *dim, states, weights, effective: *effective, chain_stats }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::transition::MotionModel;

    /// N(previous, 1) in one coordinate.
    struct Step;

    impl MotionModel for Step {
        fn dim(&self) -> usize {
            1
        }
    }

    impl Transition for Step {
        fn sample_block(&self, previous: &[Block], next: &mut [Block], _rng: &mut BlockRng) {
            next.copy_from_slice(previous);
        }
        fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
            -0.5 * (next[0] - previous[0]).powi(2)
        }
    }

    const STATES: [Block; 1] = [Block([0.0, 1.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0])];

    fn weighted(weights: &[f64]) -> Posterior<'_> {
        Posterior { dim: 1, states: &STATES, weights, effective: 3.0, chain_stats: &[] }
    }

    #[test]
    fn the_heaviest_draw_is_found() {
        assert_eq!(weighted(&[0.2, 0.5, 0.3]).heaviest(), [1.0]);
    }

    #[test]
    fn the_predictive_density_is_the_mixture_of_steps() {
        let weights = [0.2, 0.5, 0.3];
        let exact: f64 =
            weights.iter().zip([0.0, 1.0, 4.0]).map(|(w, s): (_, f64)| w * (-0.5 * (2.0 - s).powi(2)).exp()).sum();
        let found = weighted(&weights).predictive_log_density(&Step, 7, &[2.0]);
        assert!((found - exact.ln()).abs() < 1e-12, "{found} for {}", exact.ln());
        // Far from all, where every term underflows.
        let far = weighted(&weights).predictive_log_density(&Step, 7, &[100.0]);
        assert!((far - (0.3_f64.ln() - 0.5 * 96.0 * 96.0)).abs() < 1e-9, "{far}");
    }

    #[test]
    fn the_last_states_of_chains_count() {
        let stat = ChainStat { acceptance: 1.0, step_factor: 1.0, ..ChainStat::default() };
        let stats = [stat; 3];
        let posterior = Posterior { chain_stats: &stats, ..weighted(&[1.0 / 3.0; 3]) };
        let exact = (0.5 * (-0.5_f64).exp() + 0.5 * (-2.0_f64).exp()).ln();
        assert!((posterior.predictive_log_density(&Step, 2, &[2.0]) - exact).abs() < 1e-12);
    }
}
