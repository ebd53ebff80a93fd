//! What a filter that takes errors as independent from frame to frame does not know where they persist.
//!
//! Observations err by e_t + n_t: n is white with the share 1 − c of the variance R, e has the rest and the correlation φ = exp(−Δt/τ) from a frame to the next (Ornstein–Uhlenbeck). A tracker that takes all of R as white keeps its gain
//! P Hᵀ R⁻¹, and its estimate stays what it is; the error of the estimate is larger than P says, by E. With the whitened rows H̃ = R^(−½) H, M = I − P A, and Y the covariance of the estimate's error with R^(−½) e,
//!
//! ```text
//! Z   = φ M Y_{t−1}
//! E_t = M E_{t−1} Mᵀ − (Z H̃ P + P H̃ᵀ Zᵀ)
//! Y_t = Z − c P H̃ᵀ
//! ```
//!
//! In a linear model E is exact, whatever observations are missing: P + E is the covariance of the estimate's error, though not the smallest that an estimate could have (one that knew of e would be better, [Bar-Shalom, Li & Kirubarajan 2001], §8.2).

use crate::Error;
use crate::lasting::rows;
use crate::linear_motion::to_rows;
use faer::Mat;

/// How errors persist.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Persistence {
    /// Share c of the variance of an error that persists.
    pub share: f64,
    /// Its correlation φ from a frame to the next.
    pub correlation: f64,
}

/// The covariance that a filter lacks, and what it takes to carry it on.
#[derive(Clone, Debug)]
pub struct PersistentErrors {
    /// E, d × d.
    missing: Mat<f64>,
    /// Y, d × m.
    with_error: Mat<f64>,
}

impl PersistentErrors {
    /// Before the first frame of a state of dimension `dim` and `count` numbers that may be observed.
    #[must_use]
    pub fn new(dim: usize, count: usize) -> Self {
        Self { missing: Mat::zeros(dim, dim), with_error: Mat::zeros(dim, count) }
    }

    /// The filter begins again: its estimate owes nothing to former frames.
    pub fn restart(&mut self) {
        self.missing.fill(0.0);
        self.with_error.fill(0.0);
    }

    /// Takes in a frame: P after it and A (d × d), and H̃ (m × d, rows of 0 for what was not observed), all row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn update(
        &mut self,
        covariance: &[f64],
        information: &[f64],
        whitened: &[f64],
        persistence: Persistence,
    ) -> Result<(), Error> {
        let (d, m) = (self.with_error.nrows(), self.with_error.ncols());
        let covariance = rows("filtered covariance", covariance, d, d)?;
        let information = rows("information of the state", information, d, d)?;
        let whitened = rows("whitened observation", whitened, m, d)?;
        let kept = Mat::<f64>::identity(d, d) - &covariance * information;
        let gain = whitened * &covariance;
        let carried = faer::Scale(persistence.correlation) * (&kept * &self.with_error);
        let common = &carried * &gain;
        self.missing = &kept * &self.missing * kept.transpose() - &common - common.transpose();
        self.with_error = carried - faer::Scale(persistence.share) * gain.transpose();
        Ok(())
    }

    /// E, d × d, row after row.
    #[must_use]
    pub fn missing(&self) -> Vec<f64> {
        to_rows(&self.missing)
    }

    /// What [`PersistentErrors::restore`] takes.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        [self.missing(), to_rows(&self.with_error)].concat()
    }

    /// Continues where another of the same sizes stood.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let (d, m) = (self.with_error.nrows(), self.with_error.ncols());
        let Some((missing, with_error)) = saved.split_at_checked(d * d) else {
            return Err(Error::Shape { name: "covariance of persistent errors", found: saved.len(), expected: d * d });
        };
        self.missing = rows("covariance of persistent errors", missing, d, d)?;
        self.with_error = rows("covariance with persistent errors", with_error, d, m)?;
        Ok(())
    }
}

/// Lower triangular L with L Lᵀ = C for a covariance that may be singular, d × d, row after row; directions of no or (by rounding) negative variance have none.
#[must_use]
pub fn root(covariance: &[f64], dim: usize) -> Vec<f64> {
    // Of the variance of a coordinate, what rounding may leave.
    const ROUNDING: f64 = 1e-10;
    let mut root = vec![0.0; dim * dim];
    for j in 0..dim {
        let (above, below) = root.split_at_mut(j * dim);
        let own = &mut below[..dim];
        for k in 0..=j {
            let other = if k < j { &above[k * dim..][..k] } else { &[] };
            let taken: f64 = other.iter().zip(&*own).map(|(a, b)| a * b).sum();
            if k < j {
                let pivot = above[k * dim + k];
                own[k] = if pivot > 0.0 { (covariance[j * dim + k] - taken) / pivot } else { 0.0 };
            } else {
                let left = covariance[j * dim + j] - own[..j].iter().map(|x| x * x).sum::<f64>();
                own[j] = if left > ROUNDING * covariance[j * dim + j].abs() { left.sqrt() } else { 0.0 };
            }
        }
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_covariance_has_a_root() {
        // Rank 2 in three dimensions.
        let (a, b) = ([1.0, 2.0, -1.0], [0.5, 0.0, 3.0]);
        let covariance: Vec<f64> = (0..9).map(|e| a[e / 3] * a[e % 3] + b[e / 3] * b[e % 3]).collect();
        let root = root(&covariance, 3);
        for (e, expected) in covariance.iter().enumerate() {
            let found: f64 = (0..3).map(|k| root[e / 3 * 3 + k] * root[e % 3 * 3 + k]).sum();
            assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
        }
        assert_eq!(super::root(&[-1e-20, 0.0, 0.0, 4.0], 2), [0.0, 0.0, 0.0, 2.0]);
    }
}
