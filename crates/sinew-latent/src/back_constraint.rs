//! Back constraints (Lawrence & Quiñonero-Candela 2006): latents that are a smooth function of the data.
//!
//! x_n = Σ_m c_m κ(y_n, y_m) with κ(y, y′) = exp(−(h/2) ‖y − y′‖²) on the standardised rows. The coefficients c take the place of the latents in learning, so that what is near in the data is near in the latent space, and a new row has a latent
//! at once.

use crate::Error;
use crate::columns::Columns;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use serde::{Deserialize, Serialize};
use sinew_core::estimators::median;

/// The map from a row to its latent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BackConstraint {
    /// h, the inverse of the squared width.
    pub inverse_width: f64,
    /// c, one row of q a row of the data.
    pub coefficients: Vec<f64>,
}

/// κ between rows of length `cols`: N × N.
pub(crate) fn kernel(rows: &[f64], cols: usize, inverse_width: f64) -> Mat<f64> {
    let row = |n: usize| &rows[n * cols..][..cols];
    let count = rows.len() / cols;
    Mat::from_fn(count, count, |i, j| similarity(row(i), row(j), inverse_width))
}

fn similarity(a: &[f64], b: &[f64], inverse_width: f64) -> f64 {
    (-0.5 * inverse_width * squared_distance(a, b)).exp()
}

pub(crate) fn squared_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// Squared distance that half of all pairs of rows have at most.
pub(crate) fn median_squared_distance(rows: &[f64], cols: usize) -> f64 {
    let rows: Vec<&[f64]> = rows.chunks_exact(cols).collect();
    let pairs = rows.iter().enumerate().flat_map(|(i, a)| rows[..i].iter().map(|b| squared_distance(a, b)));
    let mut distances: Vec<f64> = pairs.collect();
    if distances.is_empty() {
        return 1.0;
    }
    median(&mut distances)
}

impl BackConstraint {
    /// The map that leads rows (length `cols`, standardised) near to latents (rows of `dim`): kernel ridge regression with this ridge, and the median distance of two rows as width.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn fit(rows: &[f64], cols: usize, latents: &[f64], dim: usize, ridge: f64) -> Result<Self, Error> {
        let inverse_width = 1.0 / median_squared_distance(rows, cols).max(f64::MIN_POSITIVE);
        let mut similarities = kernel(rows, cols, inverse_width);
        let count = similarities.nrows();
        for i in 0..count {
            similarities[(i, i)] += ridge;
        }
        let factor = similarities.llt(Side::Lower).map_err(|_| Error::Singular { rows: count, jitter: ridge })?;
        let solution = factor.solve(Mat::from_fn(count, dim, |i, j| latents[i * dim + j]));
        let coefficients = (0..count * dim).map(|k| solution[(k / dim, k % dim)]).collect();
        Ok(Self { inverse_width, coefficients })
    }

    /// The latent of a standardised row, given those that the map was made from.
    #[must_use]
    pub fn latent(&self, row: &[f64], rows: &[f64], dim: usize) -> Vec<f64> {
        let mut latent = vec![0.0; dim];
        for (known, coefficients) in rows.chunks_exact(row.len()).zip(self.coefficients.chunks_exact(dim)) {
            let similarity = similarity(row, known, self.inverse_width);
            latent.iter_mut().zip(coefficients).for_each(|(x, c)| *x += similarity * c);
        }
        latent
    }

    pub(crate) fn check(&self, rows: usize, dim: usize) -> Result<(), Error> {
        crate::ranges::positive("inverse width of a back constraint", &[self.inverse_width])?;
        let (found, expected) = (self.coefficients.len(), rows * dim);
        if found != expected {
            return Err(Error::Shape { name: "coefficients of a back constraint", found, expected });
        }
        crate::ranges::finite("coefficient", &self.coefficients)
    }
}

/// Coefficients to latents, and gradients back, over the rows that are learned from.
pub(crate) struct BackMap {
    kernel: Mat<f64>,
    dim: usize,
}

impl BackMap {
    pub(crate) fn new(back: &BackConstraint, rows: &[f64], cols: usize, dim: usize) -> Self {
        Self { kernel: kernel(rows, cols, back.inverse_width), dim }
    }

    /// K V for V with rows of q; K is symmetric, so that this maps coefficients to latents and gradients of latents to gradients of coefficients.
    pub(crate) fn apply(&self, values: &[f64]) -> Vec<f64> {
        let values = Columns::from_rows(values, self.dim);
        let product = &self.kernel * values.view();
        (0..product.nrows() * self.dim).map(|k| product[(k / self.dim, k % self.dim)]).collect()
    }
}
