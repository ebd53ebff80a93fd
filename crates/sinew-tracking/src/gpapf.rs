//! Annealed particle filter in a latent space of poses (GPAPF; Raskin, Rudzsky & Rivlin 2007 and 2008). A **search**: what it reports is near a peak of the likelihood, and no posterior.
//!
//! The state is [λ, θ, ρ]: a place and a heading as they are, the latent of a pose ω = ℘(θ), learned from motion, and angles that no model holds, if there are any; these belong to λ below. It is [`Annealed`] behind [`Decoded`]; for each frame, with n layers and survival rate α:
//!
//! 1. λ_i += N(0, P_λ), θ_i ← φ(θ_i) + N(0, P_θ): the given transition, once a frame
//! 2. for each layer v = 1 … n: ω_i = ℘(θ_i); W_i ∝ p(z | λ_i, ω_i)^β_v with β_v by survival; v < n: resample, λ_i += N(0, α^v P_λ), θ_i += N(0, α^v P_θ)
//! 3. estimate = Σ W_i [λ_i, ω_i], a mean of poses and not of latents
//!
//! Two things may be added, neither by default. [`Config::refine`]: after the layers one more among poses, ω_i += N(0, diag(sd²)), weighed and averaged as they are, from which θ_i = ℘⁻¹(ω_i) for the next frame (the idea of 2008; the
//! motion follows what the layers found). [`Injection`]: with some probability a particle begins the frame at the latent of a training pose. Without them a lost tracker finds back only as far as its noise reaches.
//!
//! Where a Gaussian process knows nothing its mean is one pose whatever the latent is: [`Gpapf::with_variance`] counts the particles that are there ([`StepInfo::off_manifold`]). N n evaluations a frame, N more to refine.

use crate::annealed::{self, Annealed};
use crate::decoded::Decoded;
use crate::error::check_dimension;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::beside::Beside;
use sinew_core::decode::Decode;
use sinew_core::density::LogDensity;
use sinew_core::injection::{Injected, Injection};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::annealed_search::{Weighed, weigh};
use sinew_samplers::decoded::encoded;
use sinew_samplers::diffusion::diffuse;
use sinew_samplers::particles::{Particles, aggregate, resample};
use std::fmt;
use std::sync::Arc;

/// Settings; the default is the paper's five layers of 100 particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Particles and layers.
    pub annealing: annealed::Config,
    /// Standard deviations of a last layer among poses, one a coordinate of the pose after λ.
    pub refine: Option<Vec<f64>>,
    /// Latents at which particles begin a frame now and then.
    pub injection: Injection,
}

impl Default for Config {
    fn default() -> Self {
        Self { annealing: annealed::Config::raskin(), refine: None, injection: Injection::default() }
    }
}

/// Share of the prior variance that is left at a latent: 1 where the model knows nothing.
pub type Variance = Arc<dyn Fn(&[f64]) -> f64 + Send + Sync>;

/// Above this share of the prior variance a latent counts as off the manifold.
pub const OFF_MANIFOLD: f64 = 0.95;

/// The tracker.
#[derive(Clone)]
pub struct Gpapf<C, T> {
    inner: Decoded<Beside<C>, Annealed<Injected<T>>>,
    /// Standard deviations of the last layer, of [λ, ω], its survival rate and scheme.
    refine: Option<(Vec<f64>, annealed::Config)>,
    variance: Option<Variance>,
    isa: Isa,
}

impl<C: Decode, T: Transition> Gpapf<C, T> {
    /// A tracker that starts at a pose, of which `decoder` makes coordinates of [λ, θ, ρ]. `motion` moves these from frame to frame; `sd` are the standard deviations of P, half of the largest step between frames by the authors.
    ///
    /// # Errors
    /// [`Error::Dimension`], [`Error::NotEncoded`], settings out of range, or no particles.
    pub fn new(
        config: Config,
        decoder: Beside<C>,
        motion: T,
        sd: Vec<f64>,
        pose: &[f64],
        isa: Isa,
    ) -> Result<Self, Error> {
        let Config { annealing, refine, injection } = config;
        check_dimension("start", pose.len(), decoder.target_dim())?;
        let free = decoder.latent().start;
        let refine = match refine {
            Some(noise) => {
                check_dimension("standard deviations of the refinement", noise.len(), pose.len() - free)?;
                let noise = [vec![0.0; free], noise].concat();
                annealing.layers.check(&noise, pose.len())?;
                Some((noise, annealing.clone()))
            }
            None => None,
        };
        check_dimension("motion", motion.dim(), decoder.source_dim())?;
        let motion = Injected::new(motion, injection, decoder.latent())?;
        let inner = Decoded::new(decoder, pose, |start| Annealed::new(annealing, motion, sd, start, isa))?;
        Ok(Self { inner, refine, variance: None, isa })
    }

    /// The same tracker, which counts the particles whose latent is off the manifold.
    #[must_use]
    pub fn with_variance(self, variance: Variance) -> Self {
        Self { variance: Some(variance), ..self }
    }

    /// The particles [λ, θ] of the last layer.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        self.inner.tracker().particles()
    }

    fn off_manifold(&self) -> Option<f64> {
        let (variance, particles) = (self.variance.as_ref()?, self.particles());
        let is_off = |&i: &usize| variance(&particles.state(i)[self.inner.decoder().latent()]) > OFF_MANIFOLD;
        Some((0..particles.count()).filter(is_off).count() as f64 / particles.count() as f64)
    }

    /// One more layer, among poses: poses of the last one, drawn by their weights, diffused and weighed. With their sampled states.
    fn refined<O: LogDensity + ?Sized>(
        &self,
        observed: &O,
        (noise, annealing): &(Vec<f64>, annealed::Config),
        stage: Stage,
    ) -> Result<(Particles, Vec<Block>, Weighed), Error>
    where
        C: Send,
        T: Send,
    {
        let [to_resample, to_diffuse] = stage.split(["resample", "diffuse"]);
        let Posterior { dim, states, weights, .. } = self.inner.posterior();
        let mut poses = Particles::of(dim, weights.len(), states.to_vec());
        let ancestors = resample(self.particles(), annealing.layers.scheme, to_resample);
        diffuse(&mut poses, Some(ancestors), noise, self.isa, to_diffuse);
        let layer = weigh(&mut poses, observed, annealing.layers.survival, None)?;
        let sampled = encoded(poses.states(), poses.count(), self.inner.decoder()).ok_or(Error::NotEncoded)?;
        Ok((poses, sampled, layer))
    }
}

impl<C: fmt::Debug, T: fmt::Debug> fmt::Debug for Gpapf<C, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { inner, refine, isa, variance: _ } = self;
        write!(f, "Gpapf {{ {inner:?}, refine: {refine:?}, {isa:?} }}")
    }
}

impl<O: LogDensity + ?Sized, C: Decode + Send, T: Transition + Send> Tracker<O> for Gpapf<C, T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let to_refine = stage.round(0);
        let before = self.refine.is_some().then(|| self.inner.save());
        let mut info = self.inner.step(observed, stage)?;
        if let (Some(refinement), Some(before)) = (&self.refine, before) {
            match self.refined(observed, refinement, to_refine) {
                Ok((poses, sampled, layer)) => {
                    info.mean = aggregate(&poses);
                    info.ess = layer.survivors;
                    info.exponents.push(layer.exponent);
                    info.survivors.push(layer.survivors);
                    info.likelihood_evaluations += poses.count();
                    let tracker = self.inner.replace(poses.states().to_vec(), info.mean.clone());
                    tracker.particles_mut().restore(sampled, poses.log_weights(), poses.weights());
                }
                Err(error) => {
                    self.inner.restore(&before)?;
                    return Err(error);
                }
            }
        }
        Ok(StepInfo { off_manifold: self.off_manifold(), log_evidence: None, ..info })
    }
}

impl<C: Decode, T: MotionModel> Inferred for Gpapf<C, T> {
    /// The last layer with its weights: of a search, and no posterior.
    fn posterior(&self) -> Posterior<'_> {
        self.inner.posterior()
    }

    fn estimate(&self) -> &[f64] {
        self.inner.estimate()
    }
}

impl<C, T: MotionModel> Resume for Gpapf<C, T> {
    fn save(&self) -> Vec<f64> {
        self.inner.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.inner.restore(saved)
    }
}
