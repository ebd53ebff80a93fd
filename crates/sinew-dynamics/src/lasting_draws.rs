//! How a filter's estimate moves for each of some draws of what lasts.
//!
//! [`crate::lasting`] carries the whole response J of a filter to parameters g. Where tracking continues with n draws g⁽ⁱ⁾ of them, only Δ⁽ⁱ⁾ = J (g⁽ⁱ⁾ − ĝ) is needed, a vector a draw. With the filtered covariance P of [`crate::linearised_filter`], a frame's information
//! A = Hᵀ R⁻¹ H and B = Hᵀ R⁻¹ G, and motion F = I,
//!
//! ```text
//! Δ_t = Δ_{t−1} − P_t (B (g − ĝ) + A Δ_{t−1})
//! ```

use crate::Error;
use sinew_core::combinations::add_combinations;
use sinew_core::lanes::{Block, Isa, LANES, numbers, numbers_mut};

/// Where a filter's estimate would be for each draw, less where it is.
#[derive(Clone, Debug)]
pub struct LastingMoves {
    /// Δ, a row of blocks for each coordinate of the state.
    moves: Vec<Block>,
    blocks: usize,
    isa: Isa,
}

fn same_length(name: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Shape { name, found, expected }) }
}

impl LastingMoves {
    /// Before the first frame of a state of dimension `dim`: Δ = 0 for each draw, eight to a block.
    #[must_use]
    pub fn new(dim: usize, blocks: usize, isa: Isa) -> Self {
        Self { moves: vec![Block::ZERO; dim * blocks], blocks, isa }
    }

    /// The filter begins again: its estimate no longer answers to what lasts.
    pub fn restart(&mut self) {
        self.moves.fill(Block::ZERO);
    }

    /// Takes in a frame whose filtered covariance is P and whose information is A, d × d, row after row; `pull` is B (g − ĝ), a row of blocks for each coordinate of the state.
    ///
    /// # Errors
    /// [`Error::Shape`].
    pub fn update(&mut self, covariance: &[f64], information: &[f64], mut pull: Vec<Block>) -> Result<(), Error> {
        let dim = self.moves.len() / self.blocks.max(1);
        same_length("filtered covariance", covariance.len(), dim * dim)?;
        same_length("information of the state", information.len(), dim * dim)?;
        same_length("pull of draws", pull.len(), self.moves.len())?;
        add_combinations(self.isa, information, &self.moves, &mut pull, self.blocks);
        let gain: Vec<f64> = covariance.iter().map(|x| -x).collect();
        add_combinations(self.isa, &gain, &pull, &mut self.moves, self.blocks);
        Ok(())
    }

    /// Δ, a row of blocks for each coordinate of the state.
    #[must_use]
    pub fn moves(&self) -> &[Block] {
        &self.moves
    }

    /// What [`LastingMoves::restore`] takes.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        numbers(&self.moves).to_vec()
    }

    /// Continues where another of the same sizes stood.
    ///
    /// # Errors
    /// [`Error::Shape`].
    pub fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        same_length("moves of draws", saved.len(), LANES * self.moves.len())?;
        numbers_mut(&mut self.moves).copy_from_slice(saved);
        Ok(())
    }
}
