//! Factors of covariances: Cholesky with a bounded jitter, and roots of semi-definite matrices.
//!
//! A density needs the former, draws alone the latter.
//!
//! Rules: a covariance that has no Cholesky factor gets 1e-10 · mean(diagonal) on its diagonal, times 10 up to six tries, the amount recorded; then an error. A semi-definite covariance (P₀ = 0) has a root by its
//! eigenvalues; an indefinite one is refused, naming the smallest.

use crate::Error;
use faer::{MatRef, Side};

/// A lower Cholesky factor L L' = C + jitter · I, row after row.
#[derive(Clone, Debug, PartialEq)]
pub struct Cholesky {
    /// L, d × d.
    pub lower: Vec<f64>,
    /// What was added to the diagonal; 0 if nothing had to be.
    pub jitter: f64,
}

fn checked<'a>(name: &'static str, matrix: &'a [f64], dim: usize) -> Result<MatRef<'a, f64>, Error> {
    if matrix.len() != dim * dim {
        return Err(Error::Shape { name, found: matrix.len(), expected: dim * dim });
    }
    if let Some(index) = matrix.iter().position(|x| !x.is_finite()) {
        return Err(Error::OutOfRange { name, index, value: matrix[index], expected: "must be finite" });
    }
    Ok(MatRef::from_row_major_slice(matrix, dim, dim))
}

/// Cholesky factor of a symmetric matrix, of which the lower triangle is read; `name` is what an error calls it.
///
/// # Errors
/// [`Error::Shape`], [`Error::OutOfRange`], [`Error::Indefinite`] or [`Error::Singular`].
pub fn cholesky(name: &'static str, matrix: &[f64], dim: usize) -> Result<Cholesky, Error> {
    let m = checked(name, matrix, dim)?;
    let mean = (0..dim).map(|i| m[(i, i)]).sum::<f64>() / dim as f64;
    let mut jitter = 0.0;
    for attempt in 0..=6 {
        let mut a = m.to_owned();
        for i in 0..dim {
            a[(i, i)] += jitter;
        }
        if let Ok(llt) = a.llt(Side::Lower) {
            let l = llt.L();
            let lower = (0..dim * dim).map(|k| l[(k / dim, k % dim)]).collect();
            return Ok(Cholesky { lower, jitter });
        }
        jitter = 1e-10 * mean * 10.0_f64.powi(attempt);
    }
    let smallest = smallest_eigenvalue(m);
    if smallest < -jitter.abs() {
        Err(Error::Indefinite { name, smallest })
    } else {
        Err(Error::Singular { name, jitter })
    }
}

fn smallest_eigenvalue(m: MatRef<'_, f64>) -> f64 {
    m.self_adjoint_eigenvalues(Side::Lower).ok().and_then(|e| e.first().copied()).unwrap_or(f64::NAN)
}

/// A matrix R with R R' = the given semi-definite matrix, row after row. Eigenvalues within rounding of 0 count as 0.
///
/// # Errors
/// [`Error::Shape`], [`Error::OutOfRange`] or [`Error::Indefinite`].
pub fn root(name: &'static str, matrix: &[f64], dim: usize) -> Result<Vec<f64>, Error> {
    let m = checked(name, matrix, dim)?;
    let Ok(eigen) = m.self_adjoint_eigen(Side::Lower) else {
        return Err(Error::Indefinite { name, smallest: f64::NAN });
    };
    let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
    let largest = values.iter().fold(0.0_f64, |a, &b| a.max(b.abs()));
    if let Some(&smallest) = values.first().filter(|&&v| v < -1e-10 * largest) {
        return Err(Error::Indefinite { name, smallest });
    }
    let u = eigen.U();
    Ok((0..dim * dim).map(|k| u[(k / dim, k % dim)] * values[k % dim].max(0.0).sqrt()).collect())
}

/// The covariance nearest to a symmetric matrix (Higham 1988): its negative eigenvalues are 0.
///
/// # Errors
/// [`Error::Shape`]; [`Error::Indefinite`] without eigenvalues.
pub fn positive_part(name: &'static str, matrix: &[f64], dim: usize) -> Result<Vec<f64>, Error> {
    let m = checked(name, matrix, dim)?;
    let Ok(eigen) = m.self_adjoint_eigen(Side::Lower) else {
        return Err(Error::Indefinite { name, smallest: f64::NAN });
    };
    let values: Vec<f64> = eigen.S().column_vector().iter().map(|value| value.max(0.0)).collect();
    let u = eigen.U();
    let entry = |i: usize, j: usize| (0..dim).map(|k| u[(i, k)] * values[k] * u[(j, k)]).sum();
    Ok((0..dim * dim).map(|at| entry(at / dim, at % dim)).collect())
}

/// Inverse of a lower triangular matrix with a positive diagonal, row after row.
#[must_use]
pub fn inverse_lower(lower: &[f64], dim: usize) -> Vec<f64> {
    let mut inverse = faer::Mat::<f64>::identity(dim, dim);
    MatRef::from_row_major_slice(lower, dim, dim).solve_lower_triangular_in_place(inverse.as_mut());
    (0..dim * dim).map(|k| inverse[(k / dim, k % dim)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(root: &[f64], dim: usize) -> Vec<f64> {
        (0..dim * dim).map(|k| (0..dim).map(|l| root[k / dim * dim + l] * root[k % dim * dim + l]).sum()).collect()
    }

    #[test]
    fn the_positive_part_keeps_what_is_a_covariance_and_drops_the_rest() {
        let part = |matrix: &[f64]| positive_part("matrix", matrix, 2).unwrap();
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(close(&part(&[2.0, 1.0, 1.0, 2.0]), &[2.0, 1.0, 1.0, 2.0]));
        // Eigenvalues 3 along (1, 1) and −1 along (1, −1).
        assert!(close(&part(&[1.0, 2.0, 2.0, 1.0]), &[1.5; 4]));
    }

    #[test]
    fn factors_multiply_to_the_matrix() {
        let c = [4.0, 1.0, 0.5, 1.0, 3.0, -0.2, 0.5, -0.2, 2.0];
        let factor = cholesky("C", &c, 3).expect("positive definite");
        assert_eq!(factor.jitter, 0.0);
        for product in [square(&factor.lower, 3), square(&root("C", &c, 3).expect("positive definite"), 3)] {
            assert!(product.iter().zip(&c).all(|(a, b)| (a - b).abs() < 1e-13));
        }
        let inverse = inverse_lower(&factor.lower, 3);
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (0..3).map(|k| inverse[i * 3 + k] * factor.lower[k * 3 + j]).sum();
                assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn semidefinite_has_a_root_and_a_recorded_jitter() {
        let c = [1.0, 1.0, 1.0, 1.0];
        assert!(square(&root("C", &c, 2).expect("semi-definite"), 2).iter().all(|x| (x - 1.0).abs() < 1e-13));
        assert_eq!(root("P0", &[0.0; 4], 2).expect("zero"), [0.0; 4]);
        // What counts as rounding is relative to the largest eigenvalue.
        assert_eq!(root("C", &[1e6, 0.0, 0.0, -1e-5], 2).expect("within rounding")[3], 0.0);
        assert!(root("C", &[1e-6, 0.0, 0.0, -1e-12], 2).is_err());
        let jitter = cholesky("C", &[1.0, 1.0, 1.0, 1.0 - 1e-12], 2).expect("jittered").jitter;
        assert!((jitter - 1e-10).abs() < 1e-14, "{jitter}: a first try of 1e-10 of the mean variance");
    }

    #[test]
    fn what_is_no_covariance_is_refused_by_name() {
        let indefinite = [1.0, 2.0, 2.0, 1.0];
        for error in [cholesky("Q", &indefinite, 2).unwrap_err(), root("Q", &indefinite, 2).unwrap_err()] {
            let Error::Indefinite { name: "Q", smallest } = error else { panic!("{error}") };
            assert!((smallest + 1.0).abs() < 1e-12);
        }
        assert!(matches!(cholesky("Q", &[0.0; 4], 2), Err(Error::Singular { .. })));
        assert!(matches!(cholesky("Q", &[f64::NAN; 4], 2), Err(Error::OutOfRange { .. })));
        assert!(matches!(root("Q", &[1.0; 3], 2), Err(Error::Shape { expected: 4, .. })));
    }
}
