//! Shares over the walks of a row.

/// Share of standardised errors within the 90 % interval, in per cent.
pub(super) fn inside(standardised: &[f64]) -> f64 {
    100.0 * standardised.iter().filter(|z| z.abs() < 1.645).count() as f64 / standardised.len().max(1) as f64
}
