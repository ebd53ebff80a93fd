//! How a state moves from one frame to the next.
//!
//! [`Transition`] draws and evaluates; [`GradTransition`] adds the gradient; [`PartTransition`] moves one [`Part`] only. A filter that needs the *marginal* prior of a
//! frame, given a cloud of draws of the frame before, asks for [`Predict`]: how the cloud is summarised (a mixture, a Gaussian) is a value of the transition.

use crate::density::GradLogDensity;
use crate::lanes::Block;
use crate::part::Part;
use crate::random::BlockRng;

/// A Markov transition `p(next | previous)`.
pub trait Transition: Sync {
    /// Dimension of the state.
    fn dim(&self) -> usize;

    /// Draws the next state of each lane from its previous state; all slices have one block a dimension.
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng);

    /// `log p(next | previous)` with all constants.
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64;
}

/// A transition that can be differentiated with respect to the next state.
pub trait GradTransition: Transition {
    /// `log p(next | previous)`; its gradient with respect to `next` is written to `grad`.
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64;
}

/// A transition that can move the coordinates of one part and leave the others.
pub trait PartTransition: Transition {
    /// Draws the part's coordinates of `next`, which holds the previous state on entry.
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng);
}

/// Equally weighted draws of one frame's posterior.
#[derive(Clone, Copy, Debug)]
pub struct Cloud<'a> {
    /// Blocks of eight states, `dim` blocks each, one after the other: all kept draws of the frame.
    pub draws: &'a [Block],
    /// The last states of the chains (or the resampled particles), stored alike.
    pub last: &'a [Block],
    /// Number of effectively independent draws among `draws`.
    pub effective: f64,
}

/// A transition that turns the posterior of one frame into the prior of the next.
pub trait Predict {
    /// The prior of a frame.
    type Prior: FramePrior;

    /// Prior of the frame after `cloud`'s.
    fn predict(&self, cloud: Cloud<'_>) -> Self::Prior;

    /// Prior of the first frame, centred on a given state.
    fn initial(&self, centre: &[f64]) -> Self::Prior;
}

/// Prior of one frame: a differentiable density that can also be drawn from.
pub trait FramePrior: GradLogDensity + Send {
    /// Draws a block of eight independent states.
    fn sample_block(&self, out: &mut [Block], rng: &mut BlockRng);

    /// Diagonal of an upper bound of the prior's precision, the same for every state.
    fn precision_diagonal(&self) -> &[f64];
}
