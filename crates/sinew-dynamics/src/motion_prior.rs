//! The motion of a recording: a random walk, or action primitives.
//!
//! It is one type, so that the choice is a value and trackers are made of either alike.

use crate::Error;
use crate::primitives::motion::PrimitiveMotion;
use crate::prior::Prior;
use crate::random_walk::RandomWalk;
use sinew_core::lanes::Block;
use sinew_core::random::BlockRng;
use sinew_core::transition::{Cloud, GradTransition, MotionModel, Predict, Transition};

/// The motion of a recording.
#[derive(Clone, Debug)]
pub enum MotionPrior {
    /// Independent steps of every coordinate.
    Walk(RandomWalk),
    /// What was learned from recorded motion.
    Primitives(PrimitiveMotion),
}

macro_rules! either {
    ($self:expr, $m:ident => $e:expr) => {
        match $self {
            MotionPrior::Walk($m) => $e,
            MotionPrior::Primitives($m) => $e,
        }
    };
}

impl MotionPrior {
    /// Standard deviations of a step of the random walk; of action primitives, of their third model (8).
    #[must_use]
    pub fn sd(&self) -> &[f64] {
        either!(self, m => m.sd())
    }

    /// Standard deviations of the first frame about its centre.
    #[must_use]
    pub fn initial_sd(&self) -> &[f64] {
        either!(self, m => m.initial_sd())
    }

    /// The random walk, if it is one.
    #[must_use]
    pub const fn walk(&self) -> Option<&RandomWalk> {
        match self {
            Self::Walk(walk) => Some(walk),
            Self::Primitives(_) => None,
        }
    }

    /// The same motion with another spread of the first frame about its centre.
    ///
    /// # Errors
    /// [`Error::Shape`] or [`Error::OutOfRange`].
    pub fn with_initial_sd(self, initial_sd: Vec<f64>) -> Result<Self, Error> {
        Ok(match self {
            Self::Walk(walk) => Self::Walk(walk.with_initial_sd(initial_sd)?),
            Self::Primitives(motion) => Self::Primitives(motion.with_initial_sd(initial_sd)?),
        })
    }
}

impl MotionModel for MotionPrior {
    fn dim(&self) -> usize {
        either!(self, m => m.dim())
    }

    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        either!(self, m => m.follow(before, estimate));
    }

    fn memory(&self) -> Vec<f64> {
        either!(self, m => m.memory())
    }

    fn recall(&mut self, memory: &[f64]) {
        either!(self, m => m.recall(memory));
    }
}

impl Transition for MotionPrior {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        either!(self, m => m.sample_block(previous, next, rng));
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        either!(self, m => m.sample_initial_block(centre, next, rng));
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        either!(self, m => m.log_density(previous, next))
    }
}

impl GradTransition for MotionPrior {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        either!(self, m => m.log_density_grad(previous, next, grad))
    }
}

impl Predict for MotionPrior {
    type Prior = Prior;
    type Error = Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Error> {
        either!(self, m => m.predict(cloud))
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Error> {
        either!(self, m => m.initial(centre))
    }

    fn wanted_draws(&self) -> usize {
        either!(self, m => m.wanted_draws())
    }
}
