//! Putting a tracker's state down between two steps, and taking it up again, perhaps in another process.
//!
//! Random streams are keyed by seed, purpose, frame and block ([`sinew_core::random`]), so no generator has a state that would have to be kept: the numbers that the next step needs of the steps before
//! are all there is. They are kept bit for bit, and the tracker that takes them up continues to the same bits.

use crate::Error;
use crate::error::check_dimension;
use sinew_core::lanes::{Block, LANES};
use sinew_samplers::particles::Particles;

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

/// Blocks of so many numbers.
pub(crate) fn blocks(numbers: &[f64]) -> Vec<Block> {
    numbers.as_chunks::<LANES>().0.iter().map(|lanes| Block(*lanes)).collect()
}

/// A tracker's memory that is an estimate and particles: whether it has begun, the estimate, log weights, weights, states.
pub(crate) fn put_particles(is_started: bool, estimate: &[f64], particles: &Particles) -> Vec<f64> {
    let mut saved = vec![f64::from(u8::from(is_started))];
    saved.extend(estimate);
    saved.extend(particles.log_weights());
    saved.extend(particles.weights());
    put_blocks(&mut saved, particles.states());
    saved
}

/// Takes up what [`put_particles`] put down; the numbers were checked to be as many.
pub(crate) fn take_particles(saved: &[f64], is_started: &mut bool, estimate: &mut [f64], particles: &mut Particles) {
    let (d, count) = (particles.dim(), particles.count());
    let (started, rest) = saved.split_at(1);
    let (mean, rest) = rest.split_at(d);
    let (log_weights, rest) = rest.split_at(count);
    let (weights, states) = rest.split_at(count);
    particles.restore(blocks(states), log_weights, weights);
    estimate.copy_from_slice(mean);
    *is_started = started[0] > 0.0;
}

/// How many numbers [`put_particles`] puts down.
pub(crate) fn length_of(particles: &Particles) -> usize {
    1 + particles.dim() + 2 * particles.count() + LANES * particles.states().len()
}

/// Refuses numbers that are too many or too few.
pub(crate) fn check_length(found: usize, expected: usize) -> Result<(), Error> {
    check_dimension("saved state", found, expected)
}
