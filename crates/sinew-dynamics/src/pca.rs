//! Principal component analysis that keeps a share of the variance in at most a number of components.
//!
//! With mean m and covariance C of the rows, C = U diag(v) Uᵀ: a row x has the scores Uᵀ (x − m) on the leading columns of U, the fewest whose variances add up to the stated share of trace C. Rows are centred, not
//! scaled. The sign of a component is free; here its entry of largest size is positive, the first of several.

use crate::Error;
use faer::{Mat, MatRef, Side};
use serde::{Deserialize, Serialize};

/// Leading principal components of rows of length d.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pca {
    /// Mean row, length d.
    pub mean: Vec<f64>,
    /// Unit vectors, one component after the other: q × d.
    pub components: Vec<f64>,
    /// Variances along the components, falling.
    pub variances: Vec<f64>,
    /// Sum of the variances of all coordinates.
    pub total: f64,
}

/// How many components are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keep {
    /// Share of the variance, in (0, 1].
    pub share: f64,
    /// Components at most.
    pub most: usize,
}

impl Default for Keep {
    fn default() -> Self {
        Self { share: 0.95, most: 10 }
    }
}

/// Number of rows of length `dim`, all of them finite.
pub(crate) fn count_rows(name: &'static str, rows: &[f64], dim: usize) -> Result<usize, Error> {
    if dim == 0 || rows.is_empty() {
        return Err(Error::Shape { name, found: 0, expected: dim.max(1) });
    }
    if !rows.len().is_multiple_of(dim) {
        return Err(Error::Shape { name, found: rows.len(), expected: rows.len().next_multiple_of(dim) });
    }
    match rows.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(Error::OutOfRange { name, index, value: rows[index], expected: "must be finite" }),
        None => Ok(rows.len() / dim),
    }
}

/// Mean and covariance (divided by n) of rows of length `dim`, the latter row after row.
pub(crate) fn mean_and_covariance(rows: &[f64], dim: usize) -> (Vec<f64>, Vec<f64>) {
    let count = (rows.len() / dim) as f64;
    let mut mean = vec![0.0; dim];
    for row in rows.chunks_exact(dim) {
        mean.iter_mut().zip(row).for_each(|(m, x)| *m += x);
    }
    mean.iter_mut().for_each(|m| *m /= count);
    let centred = Mat::from_fn(rows.len() / dim, dim, |n, j| rows[n * dim + j] - mean[j]);
    let product = centred.transpose() * &centred;
    let covariance = (0..dim * dim).map(|k| product[((k / dim).max(k % dim), (k / dim).min(k % dim))] / count);
    (mean, covariance.collect())
}

/// Principal components of rows of length `dim`, one after the other.
///
/// # Errors
/// [`Error::Shape`] without rows or with a broken one, [`Error::OutOfRange`] for numbers that are not finite, rows that are all equal and a share outside (0, 1].
pub fn fit(rows: &[f64], dim: usize, keep: Keep) -> Result<Pca, Error> {
    count_rows("rows", rows, dim)?;
    let (name, value) = ("share of variance", keep.share);
    if !(value > 0.0 && value <= 1.0) {
        return Err(Error::OutOfRange { name, index: 0, value, expected: "must be in (0, 1]" });
    }
    if keep.most == 0 {
        return Err(Error::Shape { name: "components", found: 0, expected: 1 });
    }
    let (mean, covariance) = mean_and_covariance(rows, dim);
    let total: f64 = (0..dim).map(|j| covariance[j * (dim + 1)]).sum();
    let varies = "must be positive and finite: all rows are equal, or far too large";
    let out = |value| Error::OutOfRange { name: "variance of the rows", index: 0, value, expected: varies };
    if !(total > 0.0 && total.is_finite()) {
        return Err(out(total));
    }
    let eigen = MatRef::from_row_major_slice(&covariance, dim, dim).self_adjoint_eigen(Side::Lower);
    let eigen = eigen.map_err(|_| out(total))?;
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let (mut variances, mut components, mut kept) = (Vec::new(), Vec::new(), 0.0);
    // Eigenvalues rise.
    for k in (0..dim).rev().take(keep.most) {
        let column: Vec<f64> = (0..dim).map(|j| vectors[(j, k)]).collect();
        let largest = column.iter().fold(0.0_f64, |a, &b| if b.abs() > a.abs() { b } else { a });
        components.extend(column.iter().map(|x| x * largest.signum()));
        let variance = values[k].max(0.0);
        variances.push(variance);
        kept += variance;
        if kept >= keep.share * total {
            break;
        }
    }
    Ok(Pca { mean, components, variances, total })
}

impl Pca {
    /// Number q of components.
    #[must_use]
    pub fn len(&self) -> usize {
        self.variances.len()
    }

    /// Whether there are no components; never so after [`fit`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.variances.is_empty()
    }

    /// Share of the variance that the components hold.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.variances.iter().sum::<f64>() / self.total
    }

    /// Scores of a row, length q.
    #[must_use]
    pub fn project(&self, row: &[f64]) -> Vec<f64> {
        let score = |component: &[f64]| {
            let terms = component.iter().zip(row).zip(&self.mean);
            terms.map(|((u, x), m)| u * (x - m)).sum()
        };
        self.components.chunks_exact(self.mean.len()).map(score).collect()
    }

    /// The row with these scores, length d.
    #[must_use]
    pub fn reconstruct(&self, scores: &[f64]) -> Vec<f64> {
        let mut row = self.mean.clone();
        for (component, score) in self.components.chunks_exact(self.mean.len()).zip(scores) {
            row.iter_mut().zip(component).for_each(|(x, u)| *x += score * u);
        }
        row
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::lanes::{Block, Isa};
    use sinew_core::random::Stage;

    const DIM: usize = 6;

    /// Rows with the standard deviations 8, 4, 2, 1, 0.5, 0.25, turned and moved.
    fn rows() -> Vec<f64> {
        let mut noise = vec![Block::ZERO; DIM * 50];
        Stage::new(5, "pca").whole().fill_normal(Isa::baseline(), &mut noise);
        let turn = Mat::from_fn(DIM, DIM, |i, j| ((i * 7 + j * 3) as f64).sin());
        let turn = turn.qr().compute_Q();
        let numbers: Vec<f64> = noise.iter().flat_map(|block| block.0).collect();
        let turned = |z: &[f64]| -> Vec<f64> {
            let scaled: Vec<f64> = (0..DIM).map(|j| 8.0 * 0.5_f64.powi(j as i32) * z[j]).collect();
            (0..DIM).map(|i| 3.0 + (0..DIM).map(|j| turn[(i, j)] * scaled[j]).sum::<f64>()).collect()
        };
        numbers.chunks_exact(DIM).flat_map(turned).collect()
    }

    fn lost(pca: &Pca, rows: &[f64]) -> f64 {
        let square = |row: &[f64]| {
            let back = pca.reconstruct(&pca.project(row));
            row.iter().zip(back).map(|(a, b)| (a - b).powi(2)).sum::<f64>()
        };
        rows.chunks_exact(DIM).map(square).sum::<f64>() / (rows.len() / DIM) as f64
    }

    /// Variance that principal components keep (M2): what the components do not hold is what reconstruction loses, and one component less would hold too little.
    #[test]
    fn the_stated_share_of_the_variance_is_kept() {
        let rows = rows();
        for share in [0.5, 0.9, 0.95, 0.999, 1.0] {
            let pca = fit(&rows, DIM, Keep { share, most: 10 }).expect("valid");
            let q = pca.len();
            assert!(pca.share() >= share - 1e-12, "{share}: {}", pca.share());
            assert!(q == 1 || pca.variances[..q - 1].iter().sum::<f64>() < share * pca.total);
            assert!((lost(&pca, &rows) - (1.0 - pca.share()) * pca.total).abs() < 1e-10 * pca.total);
        }
        let two = fit(&rows, DIM, Keep { share: 1.0, most: 2 }).expect("valid");
        assert_eq!((two.len(), two.components.len()), (2, 2 * DIM));
    }

    /// Projection after reconstruction gives the same scores (M2).
    #[test]
    fn reconstruction_and_projection_are_idempotent() {
        let rows = rows();
        let pca = fit(&rows, DIM, Keep::default()).expect("valid");
        assert!(pca.len() < DIM);
        for row in rows.chunks_exact(DIM) {
            let scores = pca.project(row);
            let again = pca.project(&pca.reconstruct(&scores));
            assert!(scores.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-10), "{scores:?} for {again:?}");
        }
        for i in 0..pca.len() {
            for j in 0..pca.len() {
                let [a, b] = [i, j].map(|k| &pca.components[k * DIM..][..DIM]);
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn signs_do_not_depend_on_the_sign_of_the_data() {
        let rows = rows();
        let mirrored: Vec<f64> = rows.iter().map(|x| -x).collect();
        let [a, b] = [&rows, &mirrored].map(|rows| fit(rows, DIM, Keep { share: 1.0, most: 10 }).expect("valid"));
        for (a, b) in a.components.chunks_exact(DIM).zip(b.components.chunks_exact(DIM)) {
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-10));
            assert!(a.iter().copied().fold(f64::MIN, f64::max) >= -a.iter().copied().fold(f64::MAX, f64::min));
        }
    }

    #[test]
    fn rows_without_variance_and_broken_ones_are_refused() {
        let keep = Keep::default();
        assert!(matches!(fit(&[1.0; 8], 2, keep), Err(Error::OutOfRange { name: "variance of the rows", .. })));
        assert!(matches!(fit(&[1.0; 7], 2, keep), Err(Error::Shape { found: 7, expected: 8, .. })));
        assert!(matches!(fit(&[], 2, keep), Err(Error::Shape { .. })));
        assert!(matches!(fit(&[1.0, f64::NAN], 2, keep), Err(Error::OutOfRange { index: 1, .. })));
        for share in [0.0, 1.1, f64::NAN] {
            assert!(fit(&[1.0, 2.0], 1, Keep { share, most: 1 }).is_err());
        }
        assert!(fit(&[1.0, 2.0], 1, Keep { share: 0.9, most: 0 }).is_err());
    }
}
