//! Means, errors and shares over the walks of a row.

/// Mean and standard error.
pub(super) fn with_error(values: &[f64]) -> String {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    format!("{mean:.3} ± {:.3}", (square / (count - 1.0).max(1.0) / count).sqrt())
}

pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Share of standardised errors within the 90 % interval, in per cent.
pub(super) fn inside(standardised: &[f64]) -> f64 {
    100.0 * standardised.iter().filter(|z| z.abs() < 1.645).count() as f64 / standardised.len().max(1) as f64
}
