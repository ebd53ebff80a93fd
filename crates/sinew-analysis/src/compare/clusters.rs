//! Covariance of least-squares estimates whose residuals are correlated within clusters of two kinds: a piece of time, and a joint.
//!
//! With a row's gradient g of its residual r by the parameters, H = Σ g gᵀ, and s_c = Σ g r over the rows of a cluster c, the covariance is H⁻¹ (M_time + M_joint − M_both) H⁻¹ with M = G/(G − 1) Σ_c s_c s_cᵀ over G clusters; clusters of `both` are a joint in a piece of time (Cameron, Gelbach and Miller, Journal of Business & Economic Statistics 29, 2011, equation 2.11). No variance is taken below that of pieces of time alone.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Parameters at most.
pub(super) const MOST: usize = 8;

/// A residual.
#[derive(Clone, Copy, Debug)]
pub(super) struct ResidualRow {
    pub(super) piece: usize,
    pub(super) joint: usize,
    pub(super) residual: f64,
    /// Derivative of the residual by each parameter; entries beyond the number of parameters are ignored.
    pub(super) gradient: [f64; MOST],
}

/// The matrix M of the module, parameters × parameters, for clusters of rows with an equal key.
fn middle<K: Ord>(rows: &[ResidualRow], parameters: usize, key: impl Fn(&ResidualRow) -> K) -> DMatrix<f64> {
    let mut sums: BTreeMap<K, DVector<f64>> = BTreeMap::new();
    for row in rows {
        let sum = sums.entry(key(row)).or_insert_with(|| DVector::zeros(parameters));
        sum.iter_mut().zip(&row.gradient).for_each(|(sum, gradient)| *sum += gradient * row.residual);
    }
    let count = sums.len() as f64;
    let mut found = DMatrix::zeros(parameters, parameters);
    sums.values().for_each(|sum| found += sum * sum.transpose());
    found * (count / (count - 1.0))
}

/// Least eigenvalue of H, scaled to a diagonal of ones, with which all parameters count as determined.
const DETERMINED: f64 = 1e-9;

fn is_determined(information: &DMatrix<f64>) -> bool {
    let scale: Vec<f64> = information.diagonal().iter().map(|own| own.sqrt().recip()).collect();
    let scaled = DMatrix::from_fn(scale.len(), scale.len(), |i, j| information[(i, j)] * scale[i] * scale[j]);
    scaled.iter().all(|entry| entry.is_finite()) && scaled.symmetric_eigenvalues().min() > DETERMINED
}

/// Standard deviations of the parameters; `None` where the rows do not determine them, or where all rows are in one piece of time.
pub(super) fn standard_deviations(rows: &[ResidualRow], parameters: usize) -> Option<Vec<f64>> {
    let mut information = DMatrix::<f64>::zeros(parameters, parameters);
    for row in rows {
        let gradient = DVector::from_column_slice(&row.gradient[..parameters]);
        information += &gradient * gradient.transpose();
    }
    if !is_determined(&information) {
        return None;
    }
    let inverse = information.cholesky()?.inverse();
    let sandwich = |middle: DMatrix<f64>| &inverse * middle * &inverse;
    let time = sandwich(middle(rows, parameters, |row| row.piece));
    let joint = sandwich(middle(rows, parameters, |row| row.joint));
    let both = sandwich(middle(rows, parameters, |row| (row.piece, row.joint)));
    let variance = |k: usize| {
        let extra = joint[(k, k)] - both[(k, k)];
        time[(k, k)] + if extra.is_finite() { extra.max(0.0) } else { 0.0 }
    };
    let found: Vec<f64> = (0..parameters).map(|k| variance(k).sqrt()).collect();
    found.iter().all(|sd| sd.is_finite()).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mean of 20 pieces of 5 values that are equal in a piece: as good as 20 values.
    #[test]
    fn values_that_hang_together_count_once() {
        let value = |piece: usize| if piece.is_multiple_of(2) { 1.0 } else { -1.0 };
        let row = |(piece, joint): (usize, usize)| {
            let mut gradient = [0.0; MOST];
            gradient[0] = 1.0;
            ResidualRow { piece, joint, residual: value(piece), gradient }
        };
        let rows: Vec<ResidualRow> =
            (0..20).flat_map(|piece| (0..5).map(move |joint| (piece, joint))).map(row).collect();
        let found = standard_deviations(&rows, 1).unwrap()[0];
        // The sum of squares is 20 · 5², times 20/19, over 100².
        assert!((found - (500.0_f64 * 20.0 / 19.0).sqrt() / 100.0).abs() < 1e-12, "{found}");
    }

    #[test]
    fn parameters_that_no_row_shows_have_no_standard_deviation() {
        let row = |piece: usize| ResidualRow { piece, joint: piece, residual: 1.0, gradient: [1.0; MOST] };
        assert!(standard_deviations(&[row(0), row(1)], 2).is_none());
        assert!(standard_deviations(&[row(0), row(0)], 1).is_none());
    }
}
