//! How a state moves from one frame to the next.
//!
//! A [`MotionModel`] may learn from the estimates of the frames. [`Transition`] draws and evaluates; [`GradTransition`] adds the gradient; [`PartTransition`] moves one [`Part`] only, [`LevelMotion`] all parts of one depth. A filter that needs the *marginal* prior of a
//! frame, given a cloud of draws of the frame before, asks for [`Predict`]: how the cloud is summarised (a mixture, a Gaussian) is a value of the transition.

use crate::density::GradLogDensity;
use crate::lanes::{Block, LANES};
use crate::part::Part;
use crate::random::BlockRng;

/// What all motion models are: of a state, and perhaps moved by the estimates so far, as a drift by their last change or a switch between activities is.
///
/// A tracker calls [`MotionModel::follow`] once at the end of every frame, and keeps [`MotionModel::memory`] with its own state. So a model never asks which tracker it serves, and no tracker knows what its model remembers.
///
/// Law `memory_resumes`: memories of one model have one length, and a model that recalls the memory of an equally made one moves states to the same bits.
pub trait MotionModel: Sync {
    /// Dimension of the state.
    fn dim(&self) -> usize;

    /// Takes in the estimate of a frame, with that of the frame before; of the first frame alone. By default nothing is remembered.
    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        let _ = (before, estimate);
    }

    /// What the next frame needs of the estimates so far.
    fn memory(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Takes up a memory of its own length.
    fn recall(&mut self, memory: &[f64]) {
        let _ = memory;
    }
}

/// A Markov transition `p(next | previous)`, given what its [`MotionModel`] remembers.
pub trait Transition: MotionModel {
    /// Draws the next state of each lane from its previous state; all slices have one block a dimension.
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng);

    /// Draws a block of states of the first frame around a given one; by default, a step from it.
    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let previous: Vec<Block> = centre.iter().map(|&x| Block::splat(x)).collect();
        self.sample_block(&previous, next, rng);
    }

    /// `log p(next | previous)` with all constants.
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64;
}

/// A transition that can be differentiated with respect to the next state.
pub trait GradTransition: Transition {
    /// `log p(next | previous)`; its gradient with respect to `next` is written to `grad`.
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64;
}

/// A transition that can move the coordinates of one part and leave the others.
///
/// Law: moving the parts of a partition one after the other draws from the transition, and drawing them one after the other around a centre draws a state of the first frame.
pub trait PartTransition: Transition {
    /// Draws the part's coordinates of `next`, which holds the previous state on entry, in the parts before this one already moved.
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng);

    /// Draws the part's coordinates of states of the first frame around a given one; by default, a step from it.
    fn sample_initial_part_block(&self, part: &Part, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        for &j in part.indices() {
            next[j] = Block::splat(centre[j]);
        }
        self.sample_part_block(part, next, rng);
    }
}

/// By which of a motion's ways one part of eight states was moved: numbers that the motion gives a meaning, 0 where it has one way only.
pub type Choices = [u32; LANES];

/// A motion that moves a state level by level down a tree of parts: the parts of one depth, and slightly those above them.
///
/// What one frame moves in all is no transition with a density: a coordinate may be moved at several levels, and later ones may overwrite what earlier ones set.
pub trait LevelMotion: MotionModel {
    /// Moves one level of eight states; `before` are the states of the frame before, whose parts went with the parts of `next`. A motion that has several ways to move a part sets the number of the one it took
    /// in `choices`, of each part it moved by itself.
    fn sample_level_block(
        &self,
        level: usize,
        before: &[Block],
        next: &mut [Block],
        choices: &mut [Choices],
        rng: &mut BlockRng,
    );

    /// Standard deviations of the random walk of each coordinate: what counts as near.
    fn step_sd(&self) -> &[f64];

    /// From one value of a coordinate to another, the short way round where it turns.
    fn change(&self, coordinate: usize, from: f64, to: f64) -> f64 {
        let _ = coordinate;
        to - from
    }

    /// Log ψ: how plausible some coordinates of a block of states are by themselves. By default all are alike.
    fn log_plausibility_block(&self, coordinates: &[usize], x: &[Block]) -> Block {
        let _ = (coordinates, x);
        Block::ZERO
    }
}

/// Mean and covariance of a distribution on the state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments {
    /// Mean, length d.
    pub mean: Vec<f64>,
    /// Covariance, d × d, row after row.
    pub covariance: Vec<f64>,
}

/// What a filter hands from one frame to the next: the posterior as last states and as moments.
#[derive(Clone, Copy, Debug)]
pub struct Cloud<'a> {
    /// Last states of the chains, or draws of them all where [`Predict::wanted_draws`] asks for more: blocks of eight states, d blocks each, one after the other.
    pub last: &'a [Block],
    /// Number of these states; lanes beyond it are to be ignored.
    pub count: usize,
    /// Moments of all kept draws, the covariance shrunk.
    pub moments: &'a Moments,
}

/// A transition that turns the posterior of one frame into the prior of the next.
pub trait Predict: MotionModel {
    /// The prior of a frame.
    type Prior: FramePrior;
    /// Why there is no prior, for instance a covariance that cannot be factored.
    type Error: core::error::Error + Send + Sync + 'static;

    /// Prior of the frame after `cloud`'s.
    ///
    /// # Errors
    /// [`Predict::Error`] where the cloud has no prior.
    fn predict(&self, cloud: Cloud<'_>) -> Result<Self::Prior, Self::Error>;

    /// Prior of the first frame, centred on a given state.
    ///
    /// # Errors
    /// [`Predict::Error`] where the centre has no prior.
    fn initial(&self, centre: &[f64]) -> Result<Self::Prior, Self::Error>;

    /// How many draws of a frame the prior of the next one is to be made from, at least, where there are as many; 0 for the last states of the chains.
    fn wanted_draws(&self) -> usize {
        0
    }
}

/// Prior of one frame: a differentiable density that can also be drawn from.
pub trait FramePrior: GradLogDensity + Send {
    /// Draws states 8 · `block` to 8 · `block` + 7 of a sample of the prior. A mixture takes its components in turn, so that a sample of its size has one state from each; other priors ignore the number.
    fn sample_block(&self, block: usize, out: &mut [Block], rng: &mut BlockRng);

    /// Diagonal of an upper bound of the prior's precision, the same for every state.
    fn precision_diagonal(&self) -> &[f64];

    /// The precision for dense metrics, d × d, row after row, the same for every state. By default the diagonal bound; a prior whose components are far narrower than the whole gives the whole's.
    fn precision(&self) -> Vec<f64> {
        diagonal_matrix(self.precision_diagonal())
    }
}

/// The matrix with this diagonal, row after row.
#[must_use]
pub fn diagonal_matrix(diagonal: &[f64]) -> Vec<f64> {
    let d = diagonal.len();
    let mut matrix = vec![0.0; d * d];
    for (j, &entry) in diagonal.iter().enumerate() {
        matrix[j * (d + 1)] = entry;
    }
    matrix
}
