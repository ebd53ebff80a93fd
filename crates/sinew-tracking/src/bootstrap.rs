//! Bootstrap particle filter (Gordon, Salmond & Smith 1993), in vision CONDENSATION (Isard & Blake 1998).
//!
//! For each frame t, with N particles:
//!
//! 1. ancestors = resample(W_{t−1}), by default multinomial and in every frame
//! 2. s_i ~ p(s_t | s_{t−1} = s_ancestor(i)); in the first frame around the given start
//! 3. l_i = log p(z_t | s_i)
//! 4. W ∝ W_before exp l, where W_before = 1/N if the particles were resampled
//! 5. estimate = Σ W_i s_i, N_eff = 1 / Σ W_i², log evidence of the frame = log Σ W_before exp l
//!
//! N likelihood evaluations a frame. The evidence is unbiased on the natural scale. An effective number below ten says that N is too small for the noise and the dimension.

use crate::error::check_dimension;
use crate::particle_state::{ParticleState, are_few};
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::density::LogDensity;
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::particles::{Particles, predict_and_reweight, resample_in_room, retreat, reweight, start};
use sinew_samplers::resample::Scheme;

/// Settings; the default resamples multinomially in every frame, as in all the papers.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N.
    pub particles: usize,
    /// Resampling scheme.
    pub scheme: Scheme,
    /// The particles are resampled where N_eff / N is at most this: 1 means always, 0.5 is the usual adaptive rule, which reproductions must leave off.
    pub resample_below: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { particles: 1000, scheme: Scheme::Multinomial, resample_below: 1.0 }
    }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Bootstrap<T> {
    config: Config,
    state: ParticleState<T>,
}

impl<T: Transition> Bootstrap<T> {
    /// A filter that starts around `centre`.
    ///
    /// # Errors
    /// [`Error::Config`], [`Error::Dimension`], or no particles.
    pub fn new(config: Config, transition: T, centre: Vec<f64>) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&config.resample_below) {
            let (name, value) = ("resample_below", config.resample_below);
            return Err(Error::Config { name, value, expected: "must be between 0 and 1" });
        }
        let state = ParticleState::new(transition, centre, config.particles)?;
        Ok(Self { config, state })
    }

    /// The particles with their weights.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }
}

impl<T: Transition + Send, O: LogDensity + ?Sized> Tracker<O> for Bootstrap<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.state.estimate.len())?;
        let [to_resample, to_predict] = stage.split(["resample", "predict"]);
        let ParticleState { motion, estimate, particles, started } = &mut self.state;
        let mut resampled = false;
        let weighed = if *started {
            resampled = are_few(particles, self.config.resample_below);
            let ancestors = resampled.then(|| resample_in_room(particles, self.config.scheme, to_resample));
            predict_and_reweight(particles, ancestors, motion, observed, to_predict)
        } else {
            start(particles, motion, estimate, to_predict);
            reweight(particles, observed)
        };
        let log_evidence = match weighed {
            Ok(log_evidence) => log_evidence,
            Err(error) => {
                if *started {
                    retreat(particles);
                }
                return Err(error.into());
            }
        };
        Ok(self.state.weighed(log_evidence, resampled))
    }
}

impl<T: MotionModel> Inferred for Bootstrap<T> {
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior()
    }

    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl<T: MotionModel> Resume for Bootstrap<T> {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)
    }
}
