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
use sinew_core::elementary::exp;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};

/// Writes the normalised weights of `log_weights` and returns log Σ exp. Their bits do not depend on the instruction set.
///
/// # Errors
/// [`Error::BadWeight`], [`Error::AllWeightsZero`].
pub fn normalise(log_weights: &[f64], weights: &mut Vec<f64>) -> Result<f64, Error> {
    let max = largest_finite(log_weights)?;
    weights.clear();
    weights.extend_from_slice(log_weights);
    let sum = exponentials(weights, max);
    let factor = 1.0 / sum;
    weights.iter_mut().for_each(|w| *w *= factor);
    Ok(max + sum.ln())
}

/// The largest of some log weights.
fn largest_finite(log_weights: &[f64]) -> Result<f64, Error> {
    let (eights, rest) = log_weights.as_chunks::<LANES>();
    let mut largest = [f64::NEG_INFINITY; LANES];
    let mut all_good = true;
    for (i, l) in eights.iter().flat_map(|eight| eight.iter().enumerate()).chain(rest.iter().enumerate()) {
        all_good &= *l < f64::INFINITY;
        largest[i] = if *l > largest[i] { *l } else { largest[i] };
    }
    if let Some((index, value)) =
        log_weights.iter().enumerate().find(|(_, l)| !all_good && (l.is_nan() || **l == f64::INFINITY))
    {
        return Err(Error::BadWeight { index, value: *value });
    }
    let max = largest.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if max > f64::NEG_INFINITY { Ok(max) } else { Err(Error::AllWeightsZero { count: log_weights.len() }) }
}

/// exp(x − `max`) in place of each x, and 0 where that is below e⁻⁷⁰⁸.
struct Exponentials<'a> {
    values: &'a mut [[f64; LANES]],
    max: f64,
}

impl Kernel<Block> for Exponentials<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for eight in &mut *self.values {
            let mut block = Block(*eight);
            let x = V::load(&block) - V::splat(self.max);
            x.select_gt(-708.0, exp(x), V::splat(0.0)).store(&mut block);
            *eight = block.0;
        }
    }
}

/// Replaces each x by exp(x − `max`) and returns their sum.
fn exponentials(values: &mut [f64], max: f64) -> f64 {
    let (eights, rest) = values.as_chunks_mut::<LANES>();
    let mut last = [[f64::NEG_INFINITY; LANES]];
    last[0][..rest.len()].copy_from_slice(rest);
    for values in [eights, &mut last] {
        dispatch(Isa::baseline(), Exponentials { values, max });
    }
    rest.copy_from_slice(&last[0][..rest.len()]);
    sum(values)
}

/// Sum, in eight parts.
pub(crate) fn sum(numbers: &[f64]) -> f64 {
    sum_of(numbers, |x| x)
}

#[inline(always)]
fn sum_of(numbers: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (eights, rest) = numbers.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for eight in eights {
        for (sum, x) in sums.iter_mut().zip(eight) {
            *sum += of(*x);
        }
    }
    rest.iter().zip(&mut sums).for_each(|(x, sum)| *sum += of(*x));
    sums.iter().sum()
}

/// Effective number 1 / Σ W² of normalised weights: between 1 and their count.
#[must_use]
pub fn effective_number(weights: &[f64]) -> f64 {
    1.0 / sum_of(weights, |w| w * w)
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
