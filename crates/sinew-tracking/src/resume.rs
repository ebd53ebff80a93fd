//! Putting a tracker's state down between two steps, and taking it up again, perhaps in another process.
//!
//! Random streams are keyed by seed, purpose, frame and block ([`sinew_core::random`]), so no generator has a state that would have to be kept: the numbers that the next step needs of the steps before
//! are all there is. They are kept bit for bit, and the tracker that takes them up continues to the same bits.

use crate::Error;
use crate::error::check_dimension;
use sinew_core::lanes::{Block, LANES};

/// Trackers whose state can be put down as numbers.
pub trait Resume {
    /// What the next step needs of the steps before it.
    fn save(&self) -> Vec<f64>;

    /// Stands where the tracker stood that gave these numbers, if it was made with the same settings. There are draws again after the next step.
    ///
    /// # Errors
    /// [`Error::Dimension`] for numbers of another tracker; the state is then as it was.
    fn restore(&mut self, saved: &[f64]) -> Result<(), Error>;
}

/// Appends the numbers of blocks.
pub(crate) fn put_blocks(out: &mut Vec<f64>, blocks: &[Block]) {
    blocks.iter().for_each(|block| out.extend(block.0));
}

/// Blocks of this number of numbers.
pub(crate) fn blocks(numbers: &[f64]) -> Vec<Block> {
    numbers.as_chunks::<LANES>().0.iter().map(|lanes| Block(*lanes)).collect()
}

/// Refuses numbers that are too many or too few.
pub(crate) fn check_length(found: usize, expected: usize) -> Result<(), Error> {
    check_dimension("saved state", found, expected)
}
