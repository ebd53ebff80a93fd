//! Annealed particle search (Deutscher, Blake & Reid 2000): layers of weighting, resampling and diffusion, from broad to peaked. A **search, not a sampler**.
//!
//! With n layers, survival rate α and a base covariance P = diag(sd²):
//!
//! 1. s_i ← s_i + N(0, P)
//! 2. for v = 1 … n: l_i = log w(s_i); β_v solves D(β) = α times the number of states with a finite value ([`crate::temperature`]); W_i ∝ exp(β_v l_i)
//!    - v = n: the mean Σ W_i s_i and the state of the largest w are what was found
//!    - S ← resampled by W
//!    - v < n: s_i ← s_i + N(0, α^v P)
//!
//! The diffusion is not corrected for by weights, and the last β is whatever lets α N states survive: the states of the last layer are no sample from w, their spread is no posterior spread, and no
//! [`sinew_core::kernel::Invariant`] is claimed. One layer with β = 1 is the exception: it is a step of a bootstrap filter. For a sampler that goes from broad to peaked, see [`crate::tempered_smc`].
//!
//! Deutscher, Blake & Reid multiply the covariance by the survival rates; several programs multiply the standard deviations: [`Scaling`].

use crate::Error;
use crate::moments;
use crate::population::Population;
use crate::resample::Scheme;
use crate::temperature::{MOST, exponent};
use crate::weights::normalise;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, Isa};
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

/// Settings; the default is that of the publication.
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
}

impl Default for Config {
    fn default() -> Self {
        Self { layers: 10, survival: 0.5, scaling: Scaling::Variance, last: Last::Solve, scheme: Scheme::Multinomial }
    }
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
    let range = |name, value, inside: bool, expected| {
        if inside { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
    };
    range("number of layers", config.layers as f64, config.layers > 0, "must be at least 1")?;
    range("number of standard deviations", sd.len() as f64, sd.len() == start.dim(), "must be the state's dimension")?;
    for &sd in sd {
        range("standard deviation", sd, sd >= 0.0 && sd.is_finite(), "must be finite and not negative")?;
    }
    let [to_diffuse, to_resample] = stage.split(["diffuse", "resample"]);
    let mut population = start.clone();
    let mut exponents = Vec::with_capacity(config.layers);
    loop {
        let weightings = exponents.len();
        let factor = match config.scaling {
            Scaling::Variance => config.survival.powf(0.5 * weightings as f64),
            Scaling::StandardDeviation => config.survival.powf(weightings as f64),
        };
        let noise = to_diffuse.round(weightings);
        population.for_each_block(|block, states| {
            let mut step = vec![Block::ZERO; states.len()];
            noise.block(block as u32).fill_normal(isa, &mut step);
            for ((x, z), sd) in states.iter_mut().zip(&step).zip(sd) {
                for (x, z) in x.0.iter_mut().zip(z.0) {
                    *x += factor * sd * z;
                }
            }
        });
        let values = population.log_densities(density);
        let is_last = weightings + 1 == config.layers;
        let beta = match config.last {
            Last::Fixed(beta) if is_last => beta,
            _ => exponent(&values, config.survival, MOST)?,
        };
        exponents.push(beta);
        let tempered = |&l: &f64| if l == f64::NEG_INFINITY { l } else { beta * l };
        let mut weights = Vec::new();
        normalise(&values.iter().map(tempered).collect::<Vec<_>>(), &mut weights)?;
        let ancestors = config.scheme.ancestors(&weights, weights.len(), &mut to_resample.round(weightings).whole());
        let resampled = population.gather(&ancestors);
        if is_last {
            let best = (0..values.len()).fold(0, |best, i| if values[i] > values[best] { i } else { best });
            return Ok(Found {
                mean: moments::mean(population.states(), population.dim(), &weights),
                best: population.state(best),
                best_log_density: values[best],
                population: resampled,
                exponents,
            });
        }
        population = resampled;
    }
}
