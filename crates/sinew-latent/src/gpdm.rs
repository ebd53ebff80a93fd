//! Gaussian process dynamical model (Wang, Fleet & Hertzmann 2008): a latent space with dynamics.
//!
//! A Gaussian process leads from each latent to the next.
//!
//! ```text
//! K_Y = exp(−(b₂/2) ‖x − x′‖²) + δ/b₃                                  of all rows, outputs weighed by W
//! K_X = a₁ exp(−(a₂/2) ‖x − x′‖²) + a₃ xᵀx′ + δ/a₄                     of the rows with a successor
//! minimised: L_Y + λ L_X + Σ log a + Σ log b + ½ κ⁻² tr W²
//! ```
//!
//! λ = 1, or D/q where the dynamics are balanced (Urtasun, Fleet & Fua 2006). Columns are centred and not scaled: W does that.

use crate::Error;
use crate::covariance::Covariance;
use crate::gplvm;
use crate::model::{LatentModel, RootPrior};
use crate::outputs::Preparation;

/// How a model starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Coordinates q of a latent.
    pub dim: usize,
    /// Whether λ = D/q and not 1.
    pub balanced: bool,
    /// Whether latents are a smooth function of the rows; then the ridge of the regression that starts it.
    pub back: Option<f64>,
    /// κ.
    pub kappa: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { dim: 3, balanced: true, back: None, kappa: 1000.0 }
    }
}

/// A model of rows (length `columns`), in sequences of these lengths, to be learned.
///
/// # Errors
/// Rows that are none, not finite, or have fewer principal components than `dim`; sequences of one row, or of other rows.
pub fn model(data: &[f64], columns: usize, sequences: &[usize], config: &Config) -> Result<LatentModel, Error> {
    let noise = (-1.0_f64).exp();
    let mapping = Covariance { variance: 1.0, inverse_width: 1.0, linear: 0.0, bias: 0.0, white: noise };
    let dynamics = Covariance { variance: 0.1, inverse_width: 1.0, linear: 0.9, bias: 0.0, white: noise };
    let balance = if config.balanced { columns as f64 / config.dim as f64 } else { 1.0 };
    let prior = RootPrior::Dynamics { covariance: dynamics, learned: dynamics.present(), balance };
    let start = gplvm::Config {
        dim: config.dim,
        preparation: Preparation::Centred,
        covariance: mapping,
        prior,
        back: config.back,
    };
    let mut model = gplvm::model(data, columns, &start)?;
    // v is in W.
    model.nodes[0].learned[0] = false;
    model.sequences = sequences.to_vec();
    model.kappa = Some(config.kappa);
    model.check()?;
    Ok(model)
}
