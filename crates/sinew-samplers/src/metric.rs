//! Metrics of Hamiltonian Monte Carlo: in which units a trajectory moves.
//!
//! With a metric G (a state-independent guess of the posterior's precision) the momentum is N(0, G) and a trajectory's step η has no unit. In whitened form, with
//! G = L Lᵀ and A = L⁻ᵀ, the momentum is N(0, I) and
//!
//! ```text
//! p ← p + η/2 Aᵀ ∇ log π(x)        x ← x + η A p
//! ```
//!
//! [`Metric::Diagonal`] is Choo & Fleet's component steps (eq. 17): A = diag(1/√h). [`Metric::Dense`] is a whole matrix, of [`crate::laplace`] or of [`crate::learned`]: where coordinates are strongly correlated, as the angles of one limb are, its trajectories
//! need a few steps where the diagonal one needs a hundred. Both are made before the chains start and frozen: a metric that changed with a chain's state would destroy reversibility.

use crate::Error;
use crate::moments;
use faer::{MatRef, Side};
use sinew_core::lanes::triangle;
use sinew_core::transition::Moments;

/// Which metric a frame's chains use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Geometry {
    /// The paper's: a curvature for each coordinate.
    #[default]
    Diagonal,
    /// The full Gauss–Newton matrix.
    Dense,
}

/// A metric.
#[derive(Clone, Debug, PartialEq)]
pub enum Metric {
    /// Curvature h of each coordinate.
    Diagonal(Vec<f64>),
    /// A whole matrix.
    Dense(Dense),
}

/// The upper triangular matrix A = L⁻ᵀ of a metric G = L Lᵀ.
#[derive(Clone, Debug, PartialEq)]
pub struct Dense {
    /// A by columns: those entries that are not zero.
    pub(crate) columns: Vec<f64>,
    /// A by rows.
    pub(crate) rows: Vec<f64>,
    dim: usize,
}

impl Dense {
    /// The whitening of a positive definite matrix, d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Metric`] where it is not positive definite.
    pub fn new(matrix: &[f64], dim: usize) -> Result<Self, Error> {
        if matrix.len() != dim * dim || matrix.iter().any(|x| !x.is_finite()) {
            return Err(Error::Metric);
        }
        let factor = MatRef::from_row_major_slice(matrix, dim, dim).llt(Side::Lower).map_err(|_| Error::Metric)?;
        let mut inverse = faer::Mat::<f64>::identity(dim, dim);
        factor.L().solve_lower_triangular_in_place(inverse.as_mut());
        // A_ij = (L⁻¹)_ji, for i ≤ j.
        let columns = (0..dim).flat_map(|j| (0..=j).map(move |i| (j, i))).map(|(j, i)| inverse[(j, i)]).collect();
        let rows = (0..dim).flat_map(|i| (i..dim).map(move |j| (j, i))).map(|(j, i)| inverse[(j, i)]).collect();
        Ok(Self { columns, rows, dim })
    }

    /// `G⁻¹ b = A Aᵀ b`.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let whitened: Vec<f64> = (0..self.dim)
            .map(|j| self.columns[triangle(j, 0)..][..=j].iter().zip(b).map(|(a, b)| a * b).sum())
            .collect();
        let mut row = &self.rows[..];
        (0..self.dim)
            .map(|i| {
                let (entries, rest) = row.split_at(self.dim - i);
                row = rest;
                entries.iter().zip(&whitened[i..]).map(|(a, w)| a * w).sum()
            })
            .collect()
    }

    /// A, whole.
    fn whitening(&self) -> faer::Mat<f64> {
        faer::Mat::from_fn(self.dim, self.dim, |i, j| if i > j { 0.0 } else { self.columns[triangle(j, i)] })
    }

    /// The matrix G itself, row after row: with A = L⁻ᵀ, `G = A⁻ᵀ A⁻¹`.
    pub(crate) fn matrix(&self) -> Vec<f64> {
        let d = self.dim;
        let whitening = self.whitening();
        let mut inverse = faer::Mat::<f64>::identity(d, d);
        whitening.solve_upper_triangular_in_place(inverse.as_mut());
        let product = inverse.transpose() * &inverse;
        (0..d * d).map(|k| product[(k / d, k % d)]).collect()
    }

    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.columns.iter_mut().chain(&mut self.rows).for_each(|a| *a *= factor);
        self
    }

    pub(crate) const fn dim(&self) -> usize {
        self.dim
    }
}

impl Metric {
    /// A, whole: `G⁻¹ = A Aᵀ`.
    pub(crate) fn whitening(&self) -> faer::Mat<f64> {
        match self {
            Self::Dense(dense) => dense.whitening(),
            Self::Diagonal(h) => {
                faer::Mat::from_fn(h.len(), h.len(), |i, j| if i == j { 1.0 / h[i].sqrt() } else { 0.0 })
            }
        }
    }

    /// Shrinks the covariance C of `effective` independent draws towards what it is where the metric's own axes do not covary, and returns λ: with the whitening A,
    ///
    /// ```text
    /// C ← (1 − λ) C + λ A diag(A⁻¹ C A⁻ᵀ) Aᵀ
    /// ```
    ///
    /// A diagonal metric shrinks towards the diagonal ([`moments::shrink`]). A dense one keeps the correlations that it knows: the covariances of a direction that no observation determines come from many coordinates, and without them its variance would
    /// be lost a part in every frame.
    pub fn shrink(&self, moments: &mut Moments, effective: f64) -> f64 {
        let Self::Dense(dense) = self else { return moments::shrink(moments, effective) };
        let d = dense.dim;
        let whitening = dense.whitening();
        let mut whitened = MatRef::from_row_major_slice(&moments.covariance, d, d).to_owned();
        for _ in 0..2 {
            whitening.solve_upper_triangular_in_place(whitened.as_mut());
            whitened = whitened.transpose().to_owned();
        }
        let mut inner =
            Moments { mean: vec![0.0; d], covariance: (0..d * d).map(|k| whitened[(k / d, k % d)]).collect() };
        let lambda = moments::shrink(&mut inner, effective);
        let shrunk = &whitening * MatRef::from_row_major_slice(&inner.covariance, d, d) * whitening.transpose();
        for (k, entry) in moments.covariance.iter_mut().enumerate() {
            // Rounding must not make it asymmetric.
            *entry = 0.5 * (shrunk[(k / d, k % d)] + shrunk[(k % d, k / d)]);
        }
        lambda
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metric_keeps_the_correlations_that_it_knows() {
        // Precision of x + y is large and that of x − y is 1: draws whose covariance is the metric's inverse are left as they are, whatever their number.
        let precision = [50.5, 49.5, 49.5, 50.5];
        let covariance = [0.505, -0.495, -0.495, 0.505];
        let start = || Moments { mean: vec![0.0; 2], covariance: covariance.to_vec() };
        let metric = Metric::Dense(Dense::new(&precision, 2).expect("positive definite"));
        for effective in [0.0, 2.0, 1e6] {
            let mut known = start();
            assert_eq!(metric.shrink(&mut known, effective), 2.0 / (effective + 2.0));
            assert!(known.covariance.iter().zip(covariance).all(|(a, b)| (a - b).abs() < 1e-12), "{known:?}");
        }
        let (mut plain, mut diagonal, mut unit) = (start(), start(), start());
        moments::shrink(&mut plain, 2.0);
        Metric::Diagonal(vec![3.0, 1.0]).shrink(&mut diagonal, 2.0);
        Metric::Dense(Dense::new(&[4.0, 0.0, 0.0, 0.25], 2).expect("positive definite")).shrink(&mut unit, 2.0);
        assert_eq!(plain, diagonal);
        assert!(plain.covariance.iter().zip(&unit.covariance).all(|(a, b)| (a - b).abs() < 1e-12), "{unit:?}");
        // Of three coordinates, too: the inverse of a metric is kept.
        let dense = Dense::new(&[4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0], 3).expect("positive definite");
        let inverse: Vec<f64> =
            (0..3).flat_map(|i| dense.solve(&[0, 1, 2].map(|j| f64::from(u8::from(i == j))))).collect();
        let mut three = Moments { mean: vec![0.0; 3], covariance: inverse.clone() };
        Metric::Dense(dense).shrink(&mut three, 3.0);
        assert!(three.covariance.iter().zip(inverse).all(|(a, b)| (a - b).abs() < 1e-13), "{three:?}");
        // A covariance that the metric does not know, by the formula: A = L⁻ᵀ with L L ᵀ = G.
        let mut other = Moments { mean: vec![0.0; 2], covariance: vec![4.0, 1.0, 1.0, 1.0] };
        metric.shrink(&mut other, 2.0);
        let l = [50.5_f64.sqrt(), 49.5 / 50.5_f64.sqrt(), (50.5 - 49.5 * 49.5 / 50.5_f64).sqrt()];
        let a = [1.0 / l[0], -l[1] / (l[0] * l[2]), 1.0 / l[2]];
        let w = [4.0 * l[0] * l[0] + 2.0 * l[0] * l[1] + l[1] * l[1], l[2] * l[2]];
        let towards = [a[0] * a[0] * w[0] + a[1] * a[1] * w[1], a[1] * a[2] * w[1], a[2] * a[2] * w[1]];
        for (k, t, c) in [(0, 0, 4.0), (1, 1, 1.0), (2, 1, 1.0), (3, 2, 1.0)] {
            assert!((other.covariance[k] - 0.5 * (c + towards[t])).abs() < 1e-11, "{other:?}");
        }
    }

    #[test]
    fn whitening_undoes_the_metric() {
        let g = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        let dense = Dense::new(&g, 3).expect("positive definite");
        let mut a = [[0.0; 3]; 3];
        for j in 0..3 {
            for (i, row) in a.iter_mut().enumerate().take(j + 1) {
                row[j] = dense.columns[triangle(j, i)];
            }
        }
        let mut rows = dense.rows.iter();
        for (i, row) in a.iter().enumerate() {
            assert!(row[i..].iter().eq(rows.by_ref().take(3 - i)));
        }
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| (0..3).map(|l| a[k][i] * g[3 * k + l] * a[l][j]).sum::<f64>()).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
        let solved = dense.solve(&[1.0, 2.0, 3.0]);
        for (row, expected) in g.chunks(3).zip([1.0, 2.0, 3.0]) {
            assert!((row.iter().zip(&solved).map(|(g, x)| g * x).sum::<f64>() - expected).abs() < 1e-13);
        }
        assert!(dense.matrix().iter().zip(g).all(|(found, g)| (found - g).abs() < 1e-13));
        assert!(Dense::new(&[1.0, 2.0, 2.0, 1.0], 2).is_err());
        assert!(Dense::new(&[f64::NAN], 1).is_err());
    }
}
