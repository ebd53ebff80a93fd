//! Annealed particle search (Deutscher, Blake & Reid 2000; Deutscher & Reid 2005).
//!
//! Layers of weighting, resampling and diffusion, from broad to peaked: a **search, not a sampler**.
//!
//! With n layers, survival rate α and a base covariance P = diag(sd²), from states that were diffused by P:
//!
//! 1. for v = 1 … n: l_i = log w(s_i); β_v solves D(β) = α times the number of states with a finite value ([`crate::temperature`]); W_i ∝ exp(β_v l_i)
//! 2. v < n: S ← resampled by W, optionally with [`crate::crossover`]
//! 3. v < n: s_i ← s_i + N(0, α^v P), optionally no wider than the resampled set ([`crate::diffusion::spread`])
//!
//! The mean Σ W_i s_i of the last layer and its state of the largest w are what was found. These layers are [`anneal`], a verb on [`Particles`]; [`search`] is one whole frame.
//!
//! The diffusion is not corrected for by weights, and the last β is whatever lets α N states survive: the states of the last layer are no sample from w, their spread is no posterior spread, and no
//! [`sinew_core::kernel::Invariant`] is claimed. One layer with β = 1 is the exception: it is a step of a bootstrap filter. For a sampler that goes from broad to peaked, see [`crate::tempered_smc`].
//!
//! Deutscher, Blake & Reid multiply the covariance by the survival rates; several programs multiply the standard deviations: [`Scaling`]. A state that must not be is one with w = 0: it has no offspring in any layer.

use crate::Error;
use crate::crossover::cross;
use crate::diffusion::{diffuse, spread};
use crate::particles::{Particles, aggregate, best, evaluate, resample, temper};
use crate::population::Population;
use crate::resample::Scheme;
use crate::temperature::{MOST, exponent};
use sinew_core::density::LogDensity;
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;

/// What the survival rates shrink from layer to layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scaling {
    /// The covariance of the diffusion, as published.
    #[default]
    Variance,
    /// Its standard deviations.
    StandardDeviation,
}

/// The exponent of the last layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Last {
    /// By survival, as in every layer.
    #[default]
    Solve,
    /// This one.
    Fixed(f64),
}

/// Settings; the default is that of the publication of 2000.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Weightings n, each of every state.
    pub layers: usize,
    /// Survival rate α.
    pub survival: f64,
    /// How the diffusion shrinks.
    pub scaling: Scaling,
    /// Exponent of the last layer.
    pub last: Last,
    /// Scheme of resampling.
    pub scheme: Scheme,
    /// Whether a coordinate is diffused no wider than the resampled set is (2005).
    pub adaptive: bool,
    /// Part of the states that is crossed in each layer but the last (2005: 0.5); 0 is none.
    pub crossover: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            layers: 10,
            survival: 0.5,
            scaling: Scaling::Variance,
            last: Last::Solve,
            scheme: Scheme::Multinomial,
            adaptive: false,
            crossover: 0.0,
        }
    }
}

impl Config {
    /// Refuses settings, and standard deviations of the base diffusion for states of `dim` coordinates.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self, sd: &[f64], dim: usize) -> Result<(), Error> {
        let range = |name, value, inside: bool, expected| {
            if inside { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
        };
        range("number of layers", self.layers as f64, self.layers > 0, "must be at least 1")?;
        range("survival rate", self.survival, self.survival > 0.0 && self.survival < 1.0, "must be in (0, 1)")?;
        range("crossover", self.crossover, (0.0..=1.0).contains(&self.crossover), "must be in [0, 1]")?;
        if let Last::Fixed(beta) = self.last {
            range("last exponent", beta, beta >= 0.0 && beta.is_finite(), "must be finite and not negative")?;
        }
        range("number of standard deviations", sd.len() as f64, sd.len() == dim, "must be the state's dimension")?;
        for &sd in sd {
            range("standard deviation", sd, sd >= 0.0 && sd.is_finite(), "must be finite and not negative")?;
        }
        Ok(())
    }

    /// Standard deviations of the noise that follows `weightings` weightings, for the standard deviations of the base diffusion.
    #[must_use]
    pub fn noise(&self, sd: &[f64], weightings: usize) -> Vec<f64> {
        let factor = match self.scaling {
            Scaling::Variance => self.survival.powf(0.5 * weightings as f64),
            Scaling::StandardDeviation => self.survival.powf(weightings as f64),
        };
        sd.iter().map(|sd| factor * sd).collect()
    }
}

/// What one weighting did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Exponent β.
    pub exponent: f64,
    /// Effective number D of states that the weights leave.
    pub survivors: f64,
    /// log Σ W_i exp β l_i.
    pub log_sum: f64,
}

/// Step 1 of a layer: weighs the states by their density raised to β, where the part `survival` of the reached ones survives, or to a fixed exponent.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::AllWeightsZero`], [`Error::BadWeight`]; the weights are then those before the call.
pub fn weigh<D: LogDensity + ?Sized>(
    particles: &mut Particles,
    density: &D,
    survival: f64,
    fixed: Option<f64>,
) -> Result<Weighed, Error> {
    evaluate(particles, density);
    let exponent = match fixed {
        Some(beta) => beta,
        None => exponent(&particles.values(), survival, MOST)?,
    };
    let log_sum = temper(particles, exponent)?;
    Ok(Weighed { exponent, survivors: particles.effective_sample_size(), log_sum })
}

/// What the layers did.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Exponent β of each layer.
    pub exponents: Vec<f64>,
    /// Effective number D of states that each layer's weights leave.
    pub survivors: Vec<f64>,
    /// log Σ W_i exp β l_i of the last layer: of one layer with β = 1 the evidence, else of no meaning.
    pub log_sum: f64,
}

/// Takes equally weighted states through the layers. They end with the weights of the last one, neither resampled nor diffused after it.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::AllWeightsZero`], [`Error::BadWeight`]; the states may then stand between two layers.
pub fn anneal<D: LogDensity + ?Sized>(
    particles: &mut Particles,
    density: &D,
    sd: &[f64],
    config: &Config,
    isa: Isa,
    stage: Stage,
) -> Result<Layers, Error> {
    config.check(sd, particles.dim())?;
    let [to_resample, to_cross, to_diffuse] = stage.split(["resample", "cross", "diffuse"]);
    let mut layers = Layers { exponents: vec![], survivors: vec![], log_sum: 0.0 };
    for weightings in 1..=config.layers {
        let is_last = weightings == config.layers;
        let fixed = if let Last::Fixed(beta) = config.last { Some(beta) } else { None };
        let layer = weigh(particles, density, config.survival, fixed.filter(|_| is_last))?;
        layers.log_sum = layer.log_sum;
        layers.exponents.push(layer.exponent);
        layers.survivors.push(layer.survivors);
        if is_last {
            break;
        }
        let mut ancestors = Some(resample(particles, config.scheme, to_resample.round(weightings)));
        let mut noise = config.noise(sd, weightings);
        if config.adaptive {
            let widths = ancestors.as_ref().map(|ancestors| spread(particles, ancestors));
            noise.iter_mut().zip(widths.into_iter().flatten()).for_each(|(noise, width)| *noise = noise.min(width));
        }
        if config.crossover > 0.0
            && let Some(ancestors) = ancestors.take()
        {
            cross(particles, ancestors, config.crossover, to_cross.round(weightings));
        }
        diffuse(particles, ancestors, &noise, isa, to_diffuse.round(weightings));
    }
    Ok(layers)
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Weighted mean of the last layer.
    pub mean: Vec<f64>,
    /// State of the largest weight function in the last layer.
    pub best: Vec<f64>,
    /// Its logarithm there.
    pub best_log_density: f64,
    /// The last layer, resampled: where a search of the next frame starts from.
    pub population: Population,
    /// Exponent of each layer.
    pub exponents: Vec<f64>,
}

/// Searches for the peak of `density` from `start`, with the standard deviations of the first diffusion.
///
/// # Errors
/// [`Error::OutOfRange`], [`Error::AllWeightsZero`], [`Error::BadWeight`].
pub fn search<D: LogDensity + ?Sized>(
    density: &D,
    start: &Population,
    sd: &[f64],
    config: &Config,
    isa: Isa,
    stage: Stage,
) -> Result<Found, Error> {
    config.check(sd, start.dim())?;
    let [to_diffuse, to_anneal, to_resample] = stage.split(["diffuse", "layers", "resample"]);
    let mut particles = Particles::equally_weighted(start);
    diffuse(&mut particles, None, sd, isa, to_diffuse);
    let layers = anneal(&mut particles, density, sd, config, isa, to_anneal)?;
    let ancestors = resample(&particles, config.scheme, to_resample);
    let (index, best_log_density) = best(&particles);
    Ok(Found {
        mean: aggregate(&particles),
        best: particles.state(index),
        best_log_density,
        population: particles.population().gather(&ancestors),
        exponents: layers.exponents,
    })
}
