//! What a sampler leaves: draws chain after chain, what is known of each, and their summary.

use crate::Error;
use crate::chains::{ChainDraws, ChainStat};
use sinew_core::lanes::LANES;

/// Draws of all chains of one run.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Run {
    /// Names of the coordinates.
    pub names: Vec<String>,
    /// Number of chains.
    pub chains: usize,
    /// The draws, one chain after the other, each `names.len()` numbers.
    pub states: Vec<f64>,
    /// What is known of each draw, in the same order.
    pub stats: Vec<ChainStat>,
    /// Draws of the warm-up in the same form, where they were kept; their trajectories had other metrics and step sizes.
    pub warm_up: Option<Box<Run>>,
    /// Step size of the trajectories, in units of the learned metric; NaN where it is not one number.
    pub step_size: f64,
    /// Leapfrog steps of a trajectory of fixed length; 0 of trees.
    pub leapfrog_steps: usize,
    /// Greatest depth that a tree was allowed; 0 of trajectories of fixed length.
    pub max_depth: usize,
    /// Logarithm of the evidence by each population of tempered sequential Monte Carlo; empty for chains.
    pub log_evidence: Vec<f64>,
}

impl Run {
    /// Draws of chains that were sampled elsewhere: as many numbers a draw as names, and chains of one length, one after the other. Statistics of the draws are those of accepted ones.
    ///
    /// # Errors
    /// [`Error::Length`] for states that do not fill the chains.
    pub fn from_chains(names: Vec<String>, chains: usize, states: Vec<f64>) -> Result<Self, Error> {
        let expected = states.len() / (names.len() * chains).max(1) * names.len() * chains;
        if states.is_empty() || states.len() != expected {
            return Err(Error::Length { what: "the states of all chains", found: states.len(), expected });
        }
        let energy = f64::NAN;
        let stat =
            ChainStat { log_density: f64::NAN, acceptance: 1.0, step_factor: 1.0, energy, ..ChainStat::default() };
        let stats = vec![stat; states.len() / names.len()];
        Ok(Self { names, chains, states, stats, step_size: f64::NAN, ..Self::default() })
    }

    /// Chains of blocks of lanes.
    pub(crate) fn from_blocks(names: Vec<String>, draws: &ChainDraws) -> Self {
        let (dim, chains, kept) = (draws.dim, draws.chains, draws.stats.len() / draws.chains.max(1));
        let order = || (0..chains).flat_map(move |chain| (0..kept).map(move |r| r * chains + chain));
        let states = order().flat_map(|index| {
            let block = &draws.states[index / LANES * dim..][..dim];
            block.iter().map(move |b| b.0[index % LANES])
        });
        let (states, stats) = (states.collect(), order().map(|index| draws.stats[index]).collect());
        Self { names, chains, states, stats, step_size: f64::NAN, ..Self::default() }
    }

    /// Dimension of a draw.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.names.len()
    }

    /// Draws of one chain.
    #[must_use]
    pub fn draws(&self) -> usize {
        self.stats.len() / self.chains.max(1)
    }

    /// One draw.
    ///
    /// # Panics
    /// Where there is no such draw.
    #[must_use]
    pub fn state(&self, chain: usize, draw: usize) -> &[f64] {
        &self.states[(chain * self.draws() + draw) * self.dim()..][..self.dim()]
    }

    /// Statistics of the draws of one chain.
    ///
    /// # Panics
    /// Where there is no such chain.
    #[must_use]
    pub fn chain_stats(&self, chain: usize) -> &[ChainStat] {
        &self.stats[chain * self.draws()..][..self.draws()]
    }

    /// All draws, chain after chain.
    pub fn iter(&self) -> impl Iterator<Item = &[f64]> {
        self.states.chunks_exact(self.dim().max(1))
    }

    /// One coordinate: a series for each chain.
    #[must_use]
    pub fn series(&self, coordinate: usize) -> Vec<Vec<f64>> {
        let all: Vec<f64> = self.iter().map(|state| state[coordinate]).collect();
        all.chunks(self.draws().max(1)).map(<[f64]>::to_vec).collect()
    }

    /// The same run of quantities that a draw determines, as constrained parameters or predictions are: `of` writes as many as there are names.
    #[must_use]
    pub fn map<N: Into<String>>(&self, names: impl IntoIterator<Item = N>, of: impl Fn(&[f64], &mut [f64])) -> Self {
        self.mapped(&names.into_iter().map(Into::into).collect::<Vec<_>>(), &of)
    }

    fn mapped(&self, names: &[String], of: &dyn Fn(&[f64], &mut [f64])) -> Self {
        let mut states = vec![0.0; self.stats.len() * names.len()];
        self.iter().zip(states.chunks_exact_mut(names.len().max(1))).for_each(|(state, out)| of(state, out));
        let warm_up = self.warm_up.as_ref().map(|run| Box::new(run.mapped(names, of)));
        let (names, stats, log_evidence) = (names.to_vec(), self.stats.clone(), self.log_evidence.clone());
        Self { names, states, warm_up, stats, log_evidence, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_chain_after_chain() {
        let states = (0..12).map(f64::from).collect();
        let run = Run::from_chains(vec!["a".into(), "b".into()], 2, states).expect("two chains of three draws");
        assert_eq!((run.dim(), run.draws(), run.state(1, 0)), (2, 3, &[6.0, 7.0][..]));
        assert_eq!(run.series(1), [[1.0, 3.0, 5.0], [7.0, 9.0, 11.0]]);
        assert_eq!(run.chain_stats(1).len(), 3);
        let sums = run.map(["sum"], |x, out| out[0] = x[0] + x[1]);
        assert_eq!((sums.names.len(), sums.series(0)), (1, vec![vec![1.0, 5.0, 9.0], vec![13.0, 17.0, 21.0]]));
        for (names, states) in
            [(vec!["a".into()], vec![]), (vec!["a".into(), "b".into()], vec![0.0; 10]), (vec![], vec![1.0])]
        {
            assert!(matches!(Run::from_chains(names, 2, states), Err(Error::Length { .. })));
        }
    }
}
