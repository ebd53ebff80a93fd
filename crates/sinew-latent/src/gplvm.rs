//! Gaussian process latent variable model (Lawrence 2005): one latent space that generates all columns.
//!
//! ```text
//! K = v exp(−(g/2) ‖x − x′‖²) + b + w δ
//! −log p = (D/2) log|K| + ½ tr(K⁻¹ Y Yᵀ) + (N D/2) log 2π + ½ Σ ‖x_n‖²
//! ```
//!
//! Latents start at the leading principal components with unit variance. Where latents are N(0, I), g stays as it is: the likelihood sees g ‖x − x′‖² only, so that with g learned the prior would shrink all latents to 0.

use crate::Error;
use crate::back_constraint::BackConstraint;
use crate::columns::count_rows;
use crate::covariance::Covariance;
use crate::model::{LatentModel, LatentNode, Outputs, RootPrior};
use crate::outputs::{Preparation, Standard};
use crate::principal::principal_scores;

/// How a model starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Coordinates q of a latent.
    pub dim: usize,
    /// What is done to the columns.
    pub preparation: Preparation,
    /// Covariance at the start.
    pub covariance: Covariance,
    /// Prior of the latents.
    pub prior: RootPrior,
    /// Whether latents are a smooth function of the rows; then the ridge of the regression that starts it.
    pub back: Option<f64>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            dim: 3,
            preparation: Preparation::Standardised,
            covariance: Covariance::default(),
            prior: RootPrior::Normal,
            back: None,
        }
    }
}

/// A model of rows (length `columns`) to be learned.
///
/// # Errors
/// Rows that are none, not finite, or have fewer principal components than `dim`.
pub fn model(data: &[f64], columns: usize, config: &Config) -> Result<LatentModel, Error> {
    let rows = count_rows("data", data, columns)?;
    let standard = Standard::new(data, columns, config.preparation)?;
    let prepared = standard.apply(data);
    let latents = principal_scores(&prepared, columns, config.dim)?;
    let mut node =
        LatentNode::new(Outputs::Columns((0..columns).collect()), 0..rows, config.dim, latents, config.covariance);
    node.learned[1] &= config.prior != RootPrior::Normal;
    if let Some(ridge) = config.back {
        node.back = Some(BackConstraint::fit(&prepared, columns, &node.latents, node.dim, ridge)?);
    }
    let model = LatentModel {
        columns,
        data: data.to_vec(),
        sequences: vec![rows],
        standard,
        nodes: vec![node],
        prior: config.prior,
        kappa: None,
    };
    model.check()?;
    Ok(model)
}
