//! Gaussian-process regression from the columns that are there to the missing ones: what a model without latents reaches.
//!
//! One process a missing column on the standardised rows, k = exp(−(g/2n) ‖o − o′‖²) + a oᵀo′ + b + w δ with n columns o; a = 10⁻³, b = 0.1.

use super::task::{Outcome, Row, Task};
use sinew_latent::covariance::Covariance;
use sinew_latent::mapping::Mapping;

/// Width and noise of the process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// g.
    pub inverse_width: f64,
    /// w.
    pub white: f64,
    /// Rows of the training set from one to the next that is used.
    pub every: usize,
}

/// The judged rows, filled in.
///
/// # Errors
/// A covariance without a factor.
pub fn fill(task: &Task<'_>, config: &Config) -> Outcome<Vec<Row>> {
    let (scales, observed) = (task.scales(), task.observed());
    let rows: Vec<&Row> = task.training.iter().flat_map(|rows| rows.iter().step_by(config.every)).collect();
    let inputs = |row: &Row| -> Row { observed.iter().map(|&j| scales.apply(row, j)).collect() };
    let known: Row = rows.iter().flat_map(|row| inputs(row)).collect();
    let outputs: Row = rows.iter().flat_map(|row| task.missing.clone().map(|j| scales.apply(row, j))).collect();
    let inverse_width = config.inverse_width / observed.len() as f64;
    let covariance = Covariance { variance: 1.0, inverse_width, linear: 1e-3, bias: 0.1, white: config.white };
    let (scale, mean) = (scales.sd[task.missing.clone()].to_vec(), scales.mean[task.missing.clone()].to_vec());
    let mapping = Mapping::fit(covariance, &known, observed.len(), &outputs, scale, mean)?;
    Ok(task.with(|row| mapping.mean_at(&inputs(row))))
}
