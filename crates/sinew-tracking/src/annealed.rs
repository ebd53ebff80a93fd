//! Annealed particle filter (Deutscher, Blake & Reid 2000; Deutscher & Reid 2005). A **search**: what it reports is near a peak of the likelihood, and no posterior.
//!
//! For each frame t, with N particles, n layers, survival rate α and a base covariance P = diag(sd²):
//!
//! 1. ancestors = resample(W of the last layer of frame t − 1)
//! 2. s_i ~ p(s_t | s_{t−1} = s_ancestor(i)), by the authors s_i + N(0, P); in the first frame around the given start
//! 3. for each layer v = 1 … n ([`sinew_samplers::annealed_search::anneal`]):
//!    - l_i = log p(z_t | s_i), or −∞ where the particle is not valid
//!    - β_v solves D(β) = α N; W ∝ exp(β_v l)
//!    - v < n: S ← resample(W), optionally crossed; s_i += N(0, α^v P), optionally no wider than the set
//! 4. estimate = Σ W_i s_i
//!
//! N n likelihood evaluations a frame. With one layer and β = 1 it is a bootstrap filter, bit for bit, and then alone has an evidence. With more, resampled particles are moved without any correction and β ends where α N
//! survive, so neither the particles nor their weights represent a posterior; the last layer usually stands at one peak even where there are several.

use crate::error::check_dimension;
use crate::particle_state::ParticleState;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Sum;
use sinew_core::density::LogDensity;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::annealed_search::{self, Last, anneal};
use sinew_samplers::particles::{Particles, aggregate, best};
use std::fmt;
use std::sync::Arc;

/// Settings; the default is that of the publication of 2000.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N.
    pub particles: usize,
    /// The layers.
    pub layers: annealed_search::Config,
}

impl Default for Config {
    fn default() -> Self {
        Self { particles: 200, layers: annealed_search::Config::default() }
    }
}

impl Config {
    /// Deutscher & Reid (2005): ten layers of 200 particles, no coordinate diffused wider than the set is (soft partitions), half of the particles crossed.
    #[must_use]
    pub fn deutscher_reid() -> Self {
        let layers = annealed_search::Config { adaptive: true, crossover: 0.5, ..annealed_search::Config::default() };
        Self { particles: 200, layers }
    }

    /// Balan, Sigal & Black (2005): five layers of 200 particles.
    #[must_use]
    pub fn balan() -> Self {
        let layers = annealed_search::Config { layers: 5, ..annealed_search::Config::default() };
        Self { particles: 200, layers }
    }

    /// Five layers of 100 particles, with which Raskin, Rudzsky & Rivlin compare their trackers.
    #[must_use]
    pub fn raskin() -> Self {
        Self { particles: 100, ..Self::balan() }
    }
}

/// A density that is 0 where a state is valid and −∞ where it is not.
pub type Validity = Arc<dyn LogDensity + Send>;

/// The tracker.
#[derive(Clone)]
pub struct Annealed<T> {
    config: Config,
    sd: Vec<f64>,
    isa: Isa,
    validity: Option<Validity>,
    state: ParticleState<T>,
}

impl<T: Transition> Annealed<T> {
    /// A tracker that starts around `centre`. `transition` moves particles from frame to frame; `sd` are the standard deviations of P, in units of the state: by the authors half of the largest change that is expected
    /// between frames.
    ///
    /// # Errors
    /// [`Error::Dimension`], settings out of range, or no particles.
    pub fn new(config: Config, transition: T, sd: Vec<f64>, centre: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        let state = ParticleState::new(transition, centre, config.particles)?;
        config.layers.check(&sd, state.estimate.len())?;
        Ok(Self { config, sd, isa, validity: None, state })
    }

    /// The same tracker with particles refused where `validity` is −∞ (Balan, Sigal & Black 2005: limbs that intersect): they have weight 0 in every layer.
    ///
    /// # Errors
    /// [`Error::Dimension`].
    pub fn with_validity(self, validity: Validity) -> Result<Self, Error> {
        check_dimension("validity", validity.dim(), self.state.estimate.len())?;
        Ok(Self { validity: Some(validity), ..self })
    }

    /// The particles of the last layer with its weights.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }

    /// The same, to be put elsewhere.
    pub(crate) fn particles_mut(&mut self) -> &mut Particles {
        &mut self.state.particles
    }

    /// Particle of the largest likelihood in the last layer of the last frame, and its log likelihood.
    #[must_use]
    pub fn best(&self) -> (Vec<f64>, f64) {
        let (index, log_likelihood) = best(&self.state.particles);
        (self.state.particles.state(index), log_likelihood)
    }
}

impl<T: fmt::Debug> fmt::Debug for Annealed<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { config, sd, state, .. } = self;
        write!(f, "Annealed {{ {config:?}, sd: {sd:?}, {state:?} }}")
    }
}

impl<T: Transition + Send, O: LogDensity + ?Sized> Tracker<O> for Annealed<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.state.estimate.len())?;
        let Config { particles: count, layers: config } = &self.config;
        let [to_resample, to_predict, to_anneal] = stage.split(["resample", "predict", "layers"]);
        let mut particles = self.state.moved(Some(config.scheme), to_resample, to_predict);
        let layers = match &self.validity {
            None => anneal(&mut particles, observed, &self.sd, config, self.isa, to_anneal),
            Some(validity) => {
                anneal(&mut particles, &Sum(observed, &**validity), &self.sd, config, self.isa, to_anneal)
            }
        }?;
        let (mean, ess) = (aggregate(&particles), particles.effective_sample_size());
        self.state.particles = particles;
        let is_filter = config.layers == 1 && config.last == Last::Fixed(1.0);
        Ok(StepInfo {
            ess,
            log_evidence: is_filter.then_some(layers.log_sum),
            resampled: Some(self.state.settle(mean.clone())),
            mean,
            exponents: layers.exponents,
            survivors: layers.survivors,
            likelihood_evaluations: count * config.layers,
            ..StepInfo::default()
        })
    }
}

impl<T: MotionModel> Inferred for Annealed<T> {
    /// The last layer with its weights: of a search, and no posterior.
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior()
    }

    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl<T: MotionModel> Resume for Annealed<T> {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)
    }
}
