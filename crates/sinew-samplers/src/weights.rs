//! Weights in log space: normalising by log-sum-exp, effective number.
//!
//! With m = max l_i the normalised weights are W_i = exp(l_i − m) / Σ_j exp(l_j − m), and log Σ exp l_i = m + log Σ exp(l_i − m). The effective number is 1 / Σ W_i² (Kong, Liu & Wong 1994).
//! If every l_i is −∞, or one is NaN or +∞, there are no weights: an error, never a silent uniform.
//!
//! ```
//! use sinew_samplers::weights::normalise;
//! let mut weights = Vec::new();
//! let log_sum = normalise(&[-1000.0, -1000.0, f64::NEG_INFINITY], &mut weights)?;
//! assert_eq!(weights, [0.5, 0.5, 0.0]);
//! assert!((log_sum - (2.0_f64.ln() - 1000.0)).abs() < 1e-12);
//! # Ok::<(), sinew_samplers::Error>(())
//! ```

use crate::Error;

/// Writes the normalised weights of `log_weights` and returns log Σ exp.
///
/// # Errors
/// [`Error::BadWeight`], [`Error::AllWeightsZero`].
pub fn normalise(log_weights: &[f64], weights: &mut Vec<f64>) -> Result<f64, Error> {
    let bad = |l: f64| l.is_nan() || l == f64::INFINITY;
    if let Some(index) = log_weights.iter().position(|&l| bad(l)) {
        return Err(Error::BadWeight { index, value: log_weights[index] });
    }
    let max = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if max == f64::NEG_INFINITY {
        return Err(Error::AllWeightsZero { count: log_weights.len() });
    }
    weights.clear();
    weights.extend(log_weights.iter().map(|l| (l - max).exp()));
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    Ok(max + sum.ln())
}

/// Effective number 1 / Σ W² of normalised weights: between 1 and their count.
#[must_use]
pub fn effective_number(weights: &[f64]) -> f64 {
    1.0 / weights.iter().map(|w| w * w).sum::<f64>()
}

/// Place and value of the largest number; the first of equals, and what is no number is never chosen before one.
pub(crate) fn largest(values: &[f64]) -> (usize, f64) {
    let none = (0, f64::NEG_INFINITY);
    values.iter().copied().enumerate().fold(none, |best, next| if next.1 > best.1 { next } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shifting_the_log_weights_changes_only_their_sum() {
        let log_weights = [-3.0, 0.5, -1e4, 2.0];
        let shifted = log_weights.map(|l| l - 1e5);
        let (mut a, mut b) = (vec![], vec![]);
        let sums = (normalise(&log_weights, &mut a), normalise(&shifted, &mut b));
        assert!((sums.0.expect("finite") - sums.1.expect("finite") - 1e5).abs() < 1e-9);
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-10);
        }
    }

    #[test]
    fn no_weights_is_an_error() {
        let none = [f64::NEG_INFINITY; 3];
        assert_eq!(normalise(&none, &mut vec![]), Err(Error::AllWeightsZero { count: 3 }));
        assert_eq!(normalise(&[], &mut vec![]), Err(Error::AllWeightsZero { count: 0 }));
        let infinite = normalise(&[0.0, f64::INFINITY], &mut vec![]);
        assert_eq!(infinite, Err(Error::BadWeight { index: 1, value: f64::INFINITY }));
        assert!(matches!(normalise(&[f64::NAN], &mut vec![]), Err(Error::BadWeight { index: 0, .. })));
    }

    #[test]
    fn effective_number_runs_from_one_to_all() {
        assert_eq!(effective_number(&[0.25; 4]), 4.0);
        assert_eq!(effective_number(&[0.0, 1.0]), 1.0);
    }
}
