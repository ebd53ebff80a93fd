//! Linear motion x' = A x + N(0, Q): what it makes of moments and of blocks of states.
//!
//! All matrices are d × d, row after row.

use faer::{Mat, MatRef};
use sinew_core::lanes::{Block, LANES};
use sinew_core::transition::Moments;

/// Moments one step ahead: A m, A P Aᵀ + Q.
#[must_use]
pub fn predict(matrix: &[f64], noise: &[f64], moments: &Moments) -> Moments {
    let d = moments.mean.len();
    let a = MatRef::from_row_major_slice(matrix, d, d);
    let p = MatRef::from_row_major_slice(&moments.covariance, d, d);
    let covariance = a * p * a.transpose() + MatRef::from_row_major_slice(noise, d, d);
    let mean = matrix.chunks_exact(d).map(|row| row.iter().zip(&moments.mean).map(|(a, m)| a * m).sum()).collect();
    Moments { mean, covariance: to_rows(&symmetric(&covariance)) }
}

/// out += R x for each lane.
pub(crate) fn add_product(matrix: &[f64], x: &[Block], out: &mut [Block]) {
    for (row, out) in matrix.chunks_exact(x.len()).zip(out) {
        for (&a, x) in row.iter().zip(x) {
            for lane in 0..LANES {
                out.0[lane] += a * x.0[lane];
            }
        }
    }
}

/// The symmetric part of a matrix, which rounding takes away.
pub(crate) fn symmetric(m: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(m.nrows(), m.ncols(), |i, j| 0.5 * (m[(i, j)] + m[(j, i)]))
}

/// The entries, row after row.
pub(crate) fn to_rows(m: &Mat<f64>) -> Vec<f64> {
    (0..m.nrows() * m.ncols()).map(|k| m[(k / m.ncols(), k % m.ncols())]).collect()
}
