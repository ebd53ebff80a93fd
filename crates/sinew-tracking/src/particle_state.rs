//! What a tracker of particles keeps from frame to frame: its motion model, estimate and particles.

use crate::Error;
use crate::StepInfo;
use crate::error::check_dimension;
use crate::posterior::Posterior;
use crate::resume::{blocks, check_length, put_blocks};
use sinew_core::lanes::LANES;
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::particles::{Particles, aggregate, predict, resample, start};
use sinew_samplers::resample::Scheme;

/// Whether particles are to be resampled: their effective number is at most this share of them, but for rounding.
pub(crate) fn are_few(particles: &Particles, share: f64) -> bool {
    particles.effective_sample_size() <= share * particles.count() as f64 * (1.0 + 1e-9)
}

/// The memory of one tracker.
#[derive(Clone, Debug)]
pub(crate) struct ParticleState<T> {
    /// Moves the particles, and follows the estimates.
    pub motion: T,
    /// Estimate of the last frame, before the first one the start.
    pub estimate: Vec<f64>,
    /// Particles with their weights.
    pub particles: Particles,
    /// Whether there was a frame.
    pub started: bool,
}

impl<T: MotionModel> ParticleState<T> {
    /// `count` particles at a start.
    pub fn new(motion: T, centre: Vec<f64>, count: usize) -> Result<Self, Error> {
        check_dimension("start", centre.len(), motion.dim())?;
        let particles = Particles::new(&centre, count)?;
        Ok(Self { motion, estimate: centre, particles, started: false })
    }

    /// The particles of a new frame: moved by the transition, in the first one drawn around the start; resampled before by a scheme, or as they are.
    pub fn moved(&self, scheme: Option<Scheme>, to_resample: Stage, to_predict: Stage) -> Particles
    where
        T: Transition,
    {
        let mut particles = self.particles.clone();
        if self.started {
            let ancestors = scheme.map(|scheme| resample(&particles, scheme, to_resample));
            predict(&mut particles, ancestors, &self.motion, to_predict);
        } else {
            start(&mut particles, &self.motion, &self.estimate, to_predict);
        }
        particles
    }

    /// Ends a frame with its estimate. Returns whether there was one before.
    pub fn settle(&mut self, estimate: Vec<f64>) -> bool {
        self.motion.follow(self.started.then_some(&*self.estimate), &estimate);
        self.estimate = estimate;
        std::mem::replace(&mut self.started, true)
    }

    /// Ends a frame whose particles are weighed, with their mean as its estimate.
    pub fn weighed(&mut self, log_evidence: f64, resampled: bool) -> StepInfo {
        let (mean, ess) = (aggregate(&self.particles), self.particles.effective_sample_size());
        self.settle(mean.clone());
        StepInfo {
            mean,
            ess,
            log_evidence: Some(log_evidence),
            resampled: Some(resampled),
            likelihood_evaluations: self.particles.count(),
            ..StepInfo::default()
        }
    }

    /// The particles as draws.
    pub fn posterior(&self) -> Posterior<'_> {
        Posterior {
            dim: self.particles.dim(),
            states: self.particles.states(),
            weights: self.particles.weights(),
            effective: self.particles.effective_sample_size(),
            chain_stats: &[],
        }
    }

    /// Whether there was a frame, the estimate, log weights, weights, states, what the motion model remembers.
    pub fn save(&self) -> Vec<f64> {
        let mut saved = vec![f64::from(u8::from(self.started))];
        saved.extend(&self.estimate);
        saved.extend(self.particles.log_weights());
        saved.extend(self.particles.weights());
        put_blocks(&mut saved, self.particles.states());
        saved.extend(self.motion.memory());
        saved
    }

    /// Takes up what [`ParticleState::save`] put down.
    pub fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let (d, count, states) = (self.estimate.len(), self.particles.count(), self.particles.states().len());
        let memory = self.motion.memory().len();
        check_length(saved.len(), 1 + d + 2 * count + LANES * states + memory)?;
        let (started, rest) = saved.split_at(1);
        let (estimate, rest) = rest.split_at(d);
        let (log_weights, rest) = rest.split_at(count);
        let (weights, rest) = rest.split_at(count);
        let (states, memory) = rest.split_at(LANES * states);
        self.started = started[0] > 0.0;
        self.estimate.copy_from_slice(estimate);
        self.particles.restore(blocks(states), log_weights, weights);
        self.motion.recall(memory);
        Ok(())
    }
}
