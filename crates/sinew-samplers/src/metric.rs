//! Metrics of Hamiltonian Monte Carlo: in which units a trajectory moves.
//!
//! With a metric G (a state-independent guess of the posterior's precision) the momentum is N(0, G) and a trajectory's step η has no unit. In whitened form, with
//! G = L Lᵀ and A = L⁻ᵀ, the momentum is N(0, I) and
//!
//! ```text
//! p ← p + η/2 Aᵀ ∇ log π(x)        x ← x + η A p
//! ```
//!
//! [`Metric::Diagonal`] is Choo & Fleet's component steps (eq. 17): A = diag(1/√h). [`Metric::Dense`] is the full Gauss–Newton matrix averaged over prior draws plus the prior's precision: where
//! coordinates are strongly correlated, as the angles of one limb are, its trajectories need a few steps where the diagonal one needs a hundred. Both are made before the chains
//! start and frozen: a metric that depended on a chain's state would destroy reversibility.

use crate::Error;
use crate::curvature::curvature;
use faer::{MatRef, Side};
use sinew_core::density::{GaussNewton, triangle};
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::FramePrior;

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

    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.columns.iter_mut().chain(&mut self.rows).for_each(|a| *a *= factor);
        self
    }

    pub(crate) const fn dim(&self) -> usize {
        self.dim
    }
}

/// The metric of a frame from `draws` draws of its prior (rounded up to blocks of eight). Draws at which an entry is not finite are left out.
///
/// # Errors
/// [`Error::Metric`] where the matrix cannot be factored.
pub fn metric<O: GaussNewton + ?Sized, P: FramePrior>(
    geometry: Geometry,
    observed: &O,
    prior: &P,
    draws: usize,
    stage: Stage,
) -> Result<Metric, Error> {
    match geometry {
        Geometry::Diagonal => Ok(Metric::Diagonal(curvature(observed, prior, draws, stage))),
        Geometry::Dense => {
            let d = prior.dim();
            let mut state = vec![Block::ZERO; d];
            let mut matrix = vec![Block::ZERO; triangle(d, 0)];
            let mut ws = vec![Block::ZERO; observed.workspace()];
            let mut sums = vec![0.0; matrix.len()];
            let mut count = 0.0;
            for block in 0..draws.div_ceil(LANES) {
                prior.sample_block(block, &mut state, &mut stage.block(block as u32));
                observed.gauss_newton_block(&state, &mut matrix, &mut ws);
                for lane in 0..LANES {
                    if matrix.iter().all(|entry| entry.0[lane].is_finite()) {
                        count += 1.0;
                        for (sum, entry) in sums.iter_mut().zip(&matrix) {
                            *sum += entry.0[lane];
                        }
                    }
                }
            }
            let mut whole = prior.precision();
            for i in 0..d {
                for j in 0..=i {
                    let entry = sums[triangle(i, j)] / f64::max(count, 1.0);
                    whole[i * d + j] += entry;
                    if i != j {
                        whole[j * d + i] += entry;
                    }
                }
            }
            Ok(Metric::Dense(Dense::new(&whole, d)?))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert!(Dense::new(&[1.0, 2.0, 2.0, 1.0], 2).is_err());
        assert!(Dense::new(&[f64::NAN], 1).is_err());
    }
}
