//! How a filter's estimate moves for each of some draws of what lasts.
//!
//! [`crate::lasting`] carries the whole response J of a filter to parameters g. Where tracking continues with n draws g⁽ⁱ⁾ of them, only Δ⁽ⁱ⁾ = J (g⁽ⁱ⁾ − ĝ) is needed, a vector a draw. With the filtered covariance P of the linearised filter, a frame's information
//! A = Hᵀ R⁻¹ H and B = Hᵀ R⁻¹ G, and motion F = I,
//!
//! ```text
//! Δ_t = Δ_{t−1} − P_t (B (g − ĝ) + A Δ_{t−1}),   P_t = ((P_{t−1} + Q)⁻¹ + A)⁻¹
//! ```

use crate::Error;
use crate::lasting::{inverse, rows};
use crate::linear_motion::to_rows;
use faer::Mat;

/// Where a filter's estimate would be for each draw, less where it is.
#[derive(Clone, Debug)]
pub struct LastingMoves {
    covariance: Mat<f64>,
    /// g⁽ⁱ⁾ − ĝ, p × n.
    deviations: Mat<f64>,
    /// Δ, d × n.
    moves: Mat<f64>,
}

impl LastingMoves {
    /// Before the first frame: the prior of the state has these variances, and Δ = 0 for each of the n draws, which are given less what the filter takes for true, p × n, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn new(variances: &[f64], draws: usize, deviations: &[f64]) -> Result<Self, Error> {
        let (d, p) = (variances.len(), deviations.len() / draws.max(1));
        let deviations = rows("draws of what lasts", deviations, p, draws)?;
        let mut new = Self { covariance: Mat::zeros(d, d), deviations, moves: Mat::zeros(d, draws) };
        new.predict(variances);
        Ok(new)
    }

    /// The filter begins again with these variances: its estimate no longer answers to what lasts.
    pub fn restart(&mut self, variances: &[f64]) {
        self.covariance.fill(0.0);
        self.moves.fill(0.0);
        self.predict(variances);
    }

    /// A step of a random walk with these variances.
    pub fn predict(&mut self, variances: &[f64]) {
        variances.iter().enumerate().for_each(|(j, variance)| self.covariance[(j, j)] += variance);
    }

    /// Takes in a frame: its information A (d × d) and B (d × p), row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`]; [`Error::Indefinite`] or [`Error::Singular`] for a covariance without factor.
    pub fn update(&mut self, state: &[f64], between: &[f64]) -> Result<(), Error> {
        let (d, p) = (self.moves.nrows(), self.deviations.nrows());
        let a = rows("information of the state", state, d, d)?;
        let b = rows("information between state and what lasts", between, d, p)?;
        let before = inverse("predicted covariance", &to_rows(&self.covariance), d)?;
        self.covariance = inverse("information of the state", &to_rows(&(before + &a)), d)?;
        let pull = b * &self.deviations + a * &self.moves;
        self.moves -= &self.covariance * pull;
        Ok(())
    }

    /// Δ, d × n, row after row.
    #[must_use]
    pub fn moves(&self) -> Vec<f64> {
        to_rows(&self.moves)
    }

    /// What [`LastingMoves::restore`] takes.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        to_rows(&self.covariance).into_iter().chain(self.moves()).collect()
    }

    /// Continues where another of the same sizes stood.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let (d, n) = (self.moves.nrows(), self.moves.ncols());
        let Some((covariance, moves)) = saved.split_at_checked(d * d) else {
            return Err(Error::Shape { name: "covariance", found: saved.len(), expected: d * d });
        };
        self.covariance = rows("covariance", covariance, d, d)?;
        self.moves = rows("moves of draws", moves, d, n)?;
        Ok(())
    }
}
