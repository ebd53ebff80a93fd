//! The draws that a filter of chains hands from one frame to the next.

use crate::Error;
use crate::resume::{blocks, check_length, put_blocks};
use sinew_core::lanes::{Block, LANES};
use sinew_samplers::chains::ChainDraws;

/// Some draws, blocks of eight.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Handed {
    /// The states.
    pub(crate) states: Vec<Block>,
    /// Their number; lanes beyond it mean nothing.
    pub(crate) count: usize,
}

impl Handed {
    /// The last states of the chains; where a transition wants more, every n-th draw of all chains, n as large as leaves at least the wanted number.
    pub(crate) fn of(draws: &ChainDraws, chains: usize, wanted: usize) -> Self {
        if wanted == 0 {
            return Self { states: draws.last.clone(), count: chains };
        }
        let (d, kept) = (draws.dim, draws.stats.len());
        let every = (kept / wanted).max(1);
        let count = kept.div_ceil(every);
        let mut states = vec![Block::ZERO; d * count.div_ceil(LANES)];
        for (to, from) in (0..kept).step_by(every).enumerate() {
            for j in 0..d {
                states[to / LANES * d + j].0[to % LANES] = draws.states[from / LANES * d + j].0[from % LANES];
            }
        }
        Self { states, count }
    }

    /// Appends them to a saved state: the last states of chains, whose number is known, or the number and the states.
    pub(crate) fn put(&self, saved: &mut Vec<f64>, wanted: usize) {
        if wanted > 0 {
            saved.push(self.count as f64);
        }
        put_blocks(saved, &self.states);
    }

    /// What was saved, of dimension `dim`.
    ///
    /// # Errors
    /// [`Error::Dimension`] for another length.
    pub(crate) fn taken(saved: &[f64], dim: usize, chains: usize, wanted: usize) -> Result<Self, Error> {
        let (count, states) = match saved.split_first() {
            Some((&count, states)) if wanted > 0 => (count.max(1.0) as usize, states),
            _ => (chains, saved),
        };
        check_length(states.len(), dim.saturating_mul(LANES).saturating_mul(count.div_ceil(LANES)))?;
        Ok(Self { states: blocks(states), count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_samplers::chains::ChainStat;

    /// Draws 0, 1, … in one dimension.
    fn draws(kept: usize) -> ChainDraws {
        let block = |b: usize| Block(core::array::from_fn(|lane| (b * LANES + lane) as f64));
        let stat = ChainStat { acceptance: 1.0, step_factor: 1.0, ..ChainStat::default() };
        ChainDraws {
            dim: 1,
            chains: 2,
            states: (0..kept.div_ceil(LANES)).map(block).collect(),
            stats: vec![stat; kept],
            last: vec![Block::splat(7.0)],
            ..ChainDraws::default()
        }
    }

    #[test]
    fn draws_are_thinned_evenly_and_as_many_as_are_wanted_stay() {
        for (kept, wanted, expected) in [(50, 20, 25), (50, 400, 50), (50, 50, 50), (59, 30, 59), (60, 30, 30)] {
            let handed = Handed::of(&draws(kept), 2, wanted);
            assert_eq!(handed.count, expected, "{kept} {wanted}");
            let every = kept.div_ceil(expected) as f64;
            let last = handed.count - 1;
            assert_eq!(handed.states[last / LANES].0[last % LANES], every * last as f64);
        }
        let last = Handed::of(&draws(50), 2, 0);
        assert_eq!((last.count, &last.states[..]), (2, &[Block::splat(7.0)][..]));
    }

    #[test]
    fn saved_draws_are_restored() {
        for wanted in [0, 20] {
            let (handed, mut saved) = (Handed::of(&draws(50), 2, wanted), vec![]);
            handed.put(&mut saved, wanted);
            assert_eq!(Handed::taken(&saved, 1, 2, wanted).ok(), Some(handed));
            assert!(Handed::taken(&saved[..saved.len() - 1], 1, 2, wanted).is_err());
        }
        assert!(Handed::taken(&[f64::INFINITY], 3, 2, 20).is_err() && Handed::taken(&[], 3, 2, 20).is_err());
    }
}
