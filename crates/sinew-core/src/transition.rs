//! How a state moves from one frame to the next.
//!
//! Methods take blocks of eight states. A motion that is written for one state is a [`ScalarTransition`]; any other method on blocks is written for one state by [`lane_by_lane`].
//!
//! A [`MotionModel`] may learn from the estimates of the frames. [`Transition`] draws and evaluates; [`GradTransition`] adds the gradient; [`PartTransition`] moves one [`Part`] only, [`LevelMotion`] all parts of one depth. A filter that needs the *marginal* prior of a
//! frame, given a cloud of draws of the frame before, asks for [`Predict`]: how the cloud is summarised (a mixture, a Gaussian) is a value of the transition.

use crate::density::GradLogDensity;
use crate::lanes::{Block, LANES, get_lane, set_lane};
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

/// A transition written for one state at a time, without blocks and lanes: [`OneByOne`] makes a [`Transition`] of it.
pub trait ScalarTransition: Sync {
    /// Dimension of the state.
    fn dim(&self) -> usize;

    /// Draws the next state from the previous one.
    fn sample(&self, previous: &[f64], next: &mut [f64], rng: &mut BlockRng);

    /// Draws a state of the first frame around a given one; by default, a step from it.
    fn sample_initial(&self, centre: &[f64], next: &mut [f64], rng: &mut BlockRng) {
        self.sample(centre, next, rng);
    }

    /// `log p(next | previous)` with all constants.
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64;
}

/// A [`ScalarTransition`] that moves the coordinates of one part and leaves the others, with the law of [`PartTransition`].
pub trait ScalarPartTransition: ScalarTransition {
    /// Draws the part's coordinates of `next`, which holds the previous state on entry, in the parts before this one already moved.
    fn sample_part(&self, part: &Part, next: &mut [f64], rng: &mut BlockRng);
}

/// Moves the states of a block one after the other.
///
/// ```
/// use sinew_core::random::{BlockRng, Stage};
/// use sinew_core::transition::{OneByOne, ScalarTransition, Transition};
///
/// /// x is halved, with noise of standard deviation 1.
/// struct Halved;
/// impl ScalarTransition for Halved {
///     fn dim(&self) -> usize {
///         1
///     }
///     fn sample(&self, previous: &[f64], next: &mut [f64], rng: &mut BlockRng) {
///         next[0] = 0.5 * previous[0] + rng.normal();
///     }
///     fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
///         -0.5 * (next[0] - 0.5 * previous[0]).powi(2) - 0.5 * std::f64::consts::TAU.ln()
///     }
/// }
/// let mut eight = [sinew_core::lanes::Block::ZERO];
/// OneByOne(Halved).sample_initial_block(&[100.0], &mut eight, &mut Stage::new(1, "example").whole());
/// assert!(eight[0].0.iter().all(|x| (x - 50.0).abs() < 6.8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneByOne<T>(pub T);

impl<T: ScalarTransition> MotionModel for OneByOne<T> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
}

impl<T: ScalarTransition> Transition for OneByOne<T> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        lane_by_lane(previous, next, |previous, next| self.0.sample(previous, next, rng));
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        lane_by_lane(&[], next, |_, next| self.0.sample_initial(centre, next, rng));
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        self.0.log_density(previous, next)
    }
}

impl<T: ScalarPartTransition> PartTransition for OneByOne<T> {
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng) {
        lane_by_lane(&[], next, |_, next| self.0.sample_part(part, next, rng));
    }
}

/// Numbers of two states that [`lane_by_lane`] holds without allocation.
const FEW: usize = 64;

/// Calls a function of single states on each lane of two blocks of states, of any dimensions: it reads the first state and changes the second. So any method on blocks is written for one state.
#[inline]
pub fn lane_by_lane(from: &[Block], to: &mut [Block], mut each: impl FnMut(&[f64], &mut [f64])) {
    if let ([from], [to]) = (from, &mut *to) {
        for (from, to) in from.0.iter().zip(&mut to.0) {
            each(core::slice::from_ref(from), core::slice::from_mut(to));
        }
        return;
    }
    let length = from.len() + to.len();
    let (mut few, mut many) = ([0.0; FEW], vec![]);
    let states = if length <= FEW {
        &mut few[..length]
    } else {
        many.resize(length, 0.0);
        &mut many[..]
    };
    let (first, second) = states.split_at_mut(from.len());
    for lane in 0..LANES {
        get_lane(from, lane, first);
        get_lane(to, lane, second);
        each(first, second);
        set_lane(to, lane, second);
    }
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
