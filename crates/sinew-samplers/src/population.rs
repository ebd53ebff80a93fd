//! Equally weighted states in blocks of eight, for samplers that move whole populations within one frame.
//!
//! State i is lane i mod 8 of block i / 8. Lanes beyond `count` are drawn or copied like the others and never counted. Blocks are mapped in parallel; sums are taken in index order.

use crate::Error;
use rayon::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, LANES, set_lane};

/// A set of states.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    dim: usize,
    count: usize,
    states: Vec<Block>,
}

impl Population {
    /// States one after the other, `dim` numbers each.
    ///
    /// ```
    /// use sinew_samplers::population::Population;
    /// let population = Population::from_slice(2, &[0.0, 1.0, 10.0, 11.0, 20.0, 21.0])?;
    /// assert_eq!((population.count(), population.state(1)), (3, vec![10.0, 11.0]));
    /// # Ok::<(), sinew_samplers::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Empty`], [`Error::Uneven`].
    pub fn from_slice(dim: usize, states: &[f64]) -> Result<Self, Error> {
        let count = states.len() / dim.max(1);
        if count * dim != states.len() {
            return Err(Error::Uneven { numbers: states.len(), dim });
        }
        let state = |slot: usize| &states[slot.min(count - 1) * dim..][..dim];
        let fill = |block: usize, to: &mut [Block]| {
            (0..LANES).for_each(|lane| set_lane(to, lane, state(block * LANES + lane)));
        };
        Self::from_blocks(dim, count, fill)
    }

    /// `count` states, block by block: `fill` gets the number of a block and writes its states.
    ///
    /// # Errors
    /// [`Error::Empty`].
    pub fn from_blocks(dim: usize, count: usize, fill: impl Fn(usize, &mut [Block]) + Sync) -> Result<Self, Error> {
        if count == 0 || dim == 0 {
            return Err(Error::Empty { count, dim });
        }
        let mut population = Self { dim, count, states: vec![Block::ZERO; count.div_ceil(LANES) * dim] };
        population.for_each_block(fill);
        Ok(population)
    }

    /// Dimension of the state.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of states.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The states, blocks of `dim` [`Block`]s.
    #[must_use]
    pub fn states(&self) -> &[Block] {
        &self.states
    }

    /// One state.
    #[must_use]
    pub fn state(&self, index: usize) -> Vec<f64> {
        self.states[index / LANES * self.dim..][..self.dim].iter().map(|b| b.0[index % LANES]).collect()
    }

    /// Log density of each state.
    #[must_use]
    pub fn log_densities<D: LogDensity + ?Sized>(&self, density: &D) -> Vec<f64> {
        let scratch = || vec![Block::ZERO; density.workspace()];
        let values: Vec<Block> = self
            .states
            .par_chunks(self.dim)
            .map_init(scratch, |ws, states| density.log_density_block(states, ws))
            .collect();
        values.iter().flat_map(|b| b.0).take(self.count).collect()
    }

    /// Of blocks of states, `count` of them in use.
    pub(crate) const fn from_state_blocks(dim: usize, count: usize, states: Vec<Block>) -> Self {
        Self { dim, count, states }
    }

    /// The states of these ancestors; idle lanes repeat them.
    pub(crate) fn gather(&self, ancestors: &[usize]) -> Self {
        let (d, count) = (self.dim, ancestors.len());
        let mut states = vec![Block::ZERO; count.div_ceil(LANES) * d];
        for slot in 0..states.len() / d * LANES {
            let from = ancestors[slot % count];
            for j in 0..d {
                states[slot / LANES * d + j].0[slot % LANES] = self.states[from / LANES * d + j].0[from % LANES];
            }
        }
        Self { dim: d, count, states }
    }

    /// Changes the states of each block.
    pub(crate) fn for_each_block(&mut self, change: impl Fn(usize, &mut [Block]) + Sync) {
        self.states.par_chunks_mut(self.dim).enumerate().for_each(|(block, states)| change(block, states));
    }

    /// A population of the same size from its blocks.
    pub(crate) fn with_blocks<'a>(&self, blocks: impl Iterator<Item = &'a [Block]>) -> Self {
        Self { states: blocks.flatten().copied().collect(), ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::toy::Quadratic;

    #[test]
    fn states_are_found_where_they_were_put() {
        let fill = |block: usize, states: &mut [Block]| {
            for (j, x) in states.iter_mut().enumerate() {
                *x = Block(core::array::from_fn(|lane| (10 * (LANES * block + lane) + j) as f64));
            }
        };
        let population = Population::from_blocks(2, 11, fill).expect("not empty");
        assert_eq!(population.state(9), [90.0, 91.0]);
        let gathered = population.gather(&[9, 0, 3]);
        assert_eq!((gathered.count(), gathered.state(0), gathered.state(2)), (3, vec![90.0, 91.0], vec![30.0, 31.0]));
        assert_eq!(gathered.state(3), gathered.state(0), "idle lanes repeat the others");
        let density = Quadratic { centre: vec![0.0, 1.0], precision: vec![2.0, 1.0] };
        let values = population.log_densities(&density);
        assert_eq!((values.len(), values[3]), (11, -(30.0 * 30.0) - 0.5 * 30.0 * 30.0));
        assert!(Population::from_blocks(0, 1, fill).is_err() && Population::from_blocks(1, 0, fill).is_err());
    }
}
