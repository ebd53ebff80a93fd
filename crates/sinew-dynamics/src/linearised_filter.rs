//! The filtered covariance of a random walk whose observations are linearised.
//!
//! A tracker's own draws say how far its state may be off. What its estimate would be had the observations been others follows from the gain of the filter that is linearised at its estimates: with the information A = Hᵀ R⁻¹ H of each frame,
//!
//! ```text
//! P_t = ((P_{t−1} + Q)⁻¹ + A_t)⁻¹,   gain P_t Hᵀ R⁻¹
//! ```

use crate::Error;
use crate::lasting::{inverse, rows};
use crate::linear_motion::to_rows;
use faer::Mat;

/// The filter; only its covariance.
#[derive(Clone, Debug)]
pub struct LinearisedFilter {
    covariance: Mat<f64>,
}

impl LinearisedFilter {
    /// Before the first frame, with these variances.
    #[must_use]
    pub fn new(variances: &[f64]) -> Self {
        let mut new = Self { covariance: Mat::zeros(variances.len(), variances.len()) };
        new.predict(variances);
        new
    }

    /// A step of a random walk with these variances.
    pub fn predict(&mut self, variances: &[f64]) {
        variances.iter().enumerate().for_each(|(j, variance)| self.covariance[(j, j)] += variance);
    }

    /// Takes in a frame with the information A, d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`]; [`Error::Indefinite`] or [`Error::Singular`] for a covariance without factor.
    pub fn update(&mut self, information: &[f64]) -> Result<(), Error> {
        let d = self.covariance.nrows();
        let information = rows("information of the state", information, d, d)?;
        let before = inverse("predicted covariance", &to_rows(&self.covariance), d)?;
        self.covariance = inverse("information of the state", &to_rows(&(before + information)), d)?;
        Ok(())
    }

    /// P, d × d, row after row.
    #[must_use]
    pub fn covariance(&self) -> Vec<f64> {
        to_rows(&self.covariance)
    }

    /// Continues from a covariance that another had.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn restore(&mut self, covariance: &[f64]) -> Result<(), Error> {
        let d = self.covariance.nrows();
        self.covariance = rows("covariance", covariance, d, d)?;
        Ok(())
    }
}
