//! A tracker of a latent state, seen as a tracker of poses.
//!
//! For each frame, with a decoder ℘ and a tracker on the sampled state x:
//!
//! 1. the observation, a density of poses, becomes one of sampled states: log p(z_t | ℘(x))
//! 2. the tracker on x steps; nothing is known there of poses
//! 3. y_i = ℘(x_i) for all draws; estimate = Σ W_i y_i
//!
//! The draws y_i with the weights of the x_i are draws of the posterior of the pose. It has no density where ℘ maps to more dimensions than it maps from: the tracker explores the image of ℘ alone, and the mean of draws need not lie on it.
//! What a step says of chains (R̂, effective numbers) is said of x. A start is a pose, from which [`Decode::encode`] makes a sampled state.

use crate::error::check_dimension;
use crate::posterior::Posterior;
use crate::resume::check_length;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Through;
use sinew_core::decode::Decode;
use sinew_core::density::LogDensity;
use sinew_core::lanes::Block;
use sinew_core::random::Stage;
use sinew_samplers::decoded::decoded;
use sinew_samplers::moments;

/// The tracker.
#[derive(Clone, Debug)]
pub struct Decoded<C, K> {
    decoder: C,
    tracker: K,
    /// Draws of the last frame; none before the first one, nor after a state was restored.
    states: Vec<Block>,
    estimate: Vec<f64>,
}

impl<C: Decode, K> Decoded<C, K> {
    /// Starts at a pose: `make` gets its sampled state. The first estimate is what that state decodes to.
    ///
    /// # Errors
    /// [`Error::Dimension`], [`Error::NotEncoded`], and what `make` refuses.
    pub fn new<E: From<Error>>(
        decoder: C,
        pose: &[f64],
        make: impl FnOnce(Vec<f64>) -> Result<K, E>,
    ) -> Result<Self, E> {
        check_dimension("start", pose.len(), decoder.target_dim())?;
        let start = decoder.encode(pose).ok_or(Error::NotEncoded)?;
        let mut estimate = vec![0.0; pose.len()];
        decoder.decode(&start, &mut estimate);
        Ok(Self { tracker: make(start)?, decoder, states: vec![], estimate })
    }

    /// The tracker of the sampled state.
    #[must_use]
    pub fn tracker(&self) -> &K {
        &self.tracker
    }

    /// The decoder.
    #[must_use]
    pub fn decoder(&self) -> &C {
        &self.decoder
    }

    /// Puts other draws and another estimate in the place of the last frame's; the tracker of the sampled state is to be given theirs.
    pub(crate) fn replace(&mut self, states: Vec<Block>, estimate: Vec<f64>) -> &mut K {
        self.states = states;
        self.estimate = estimate;
        &mut self.tracker
    }
}

impl<O, C, K> Tracker<O> for Decoded<C, K>
where
    O: LogDensity + ?Sized,
    C: Decode + Send,
    K: for<'a> Tracker<Through<&'a O, &'a C>>,
{
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.decoder.target_dim())?;
        let info = self.tracker.step(&Through { target: observed, decoder: &self.decoder }, stage)?;
        let sampled = self.tracker.posterior();
        self.states = decoded(sampled.states, &self.decoder);
        self.estimate = moments::mean(&self.states, self.decoder.target_dim(), sampled.weights);
        Ok(StepInfo { mean: self.estimate.clone(), ..info })
    }
}

impl<C: Decode, K: Inferred> Inferred for Decoded<C, K> {
    fn posterior(&self) -> Posterior<'_> {
        self.tracker.posterior().as_poses(&self.states, self.decoder.target_dim())
    }

    fn estimate(&self) -> &[f64] {
        &self.estimate
    }
}

/// The estimate, which chains alone could not give again, then the numbers of the tracker of the sampled state.
impl<C, K: Resume> Resume for Decoded<C, K> {
    fn save(&self) -> Vec<f64> {
        [&self.estimate[..], &self.tracker.save()].concat()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let Some((estimate, sampled)) = saved.split_at_checked(self.estimate.len()) else {
            return check_length(saved.len(), self.estimate.len());
        };
        self.tracker.restore(sampled)?;
        self.estimate.copy_from_slice(estimate);
        self.states.clear();
        Ok(())
    }
}
