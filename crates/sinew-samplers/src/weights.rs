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
use sinew_core::lanes::{Block, Kernel, LANES, Real, dispatch_unfused};

/// Writes the normalised weights of `log_weights` and returns log Σ exp. Their bits do not depend on the instruction set.
///
/// # Errors
/// [`Error::BadWeight`], [`Error::AllWeightsZero`].
pub fn normalise(log_weights: &[f64], weights: &mut Vec<f64>) -> Result<f64, Error> {
    let max = largest_finite(log_weights)?;
    weights.resize(log_weights.len(), 0.0);
    let sum = exponentials(log_weights, max, weights);
    let factor = 1.0 / sum;
    weights.iter_mut().for_each(|w| *w *= factor);
    Ok(max + sum.ln())
}

/// The largest of some log weights.
fn largest_finite(log_weights: &[f64]) -> Result<f64, Error> {
    let (eights, rest) = log_weights.as_chunks();
    let (mut largest, mut bad) = (Block::splat(f64::NEG_INFINITY), Block::ZERO);
    for eights in [eights, &[padded(rest)]] {
        dispatch_unfused(Largest { eights, largest: &mut largest, bad: &mut bad });
    }
    let is_bad = |l: &f64| l.is_nan() || *l == f64::INFINITY;
    if bad != Block::ZERO
        && let Some(index) = log_weights.iter().position(is_bad)
    {
        return Err(Error::BadWeight { index, value: log_weights[index] });
    }
    let max = largest.0.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if max > f64::NEG_INFINITY { Ok(max) } else { Err(Error::AllWeightsZero { count: log_weights.len() }) }
}

/// Log weights that are fewer than eight, and others of weight 0.
fn padded(log_weights: &[f64]) -> [f64; LANES] {
    let mut eight = [f64::NEG_INFINITY; LANES];
    eight[..log_weights.len()].copy_from_slice(log_weights);
    eight
}

/// The largest number of each lane, and whether one was NaN or +∞.
struct Largest<'a> {
    eights: &'a [[f64; LANES]],
    largest: &'a mut Block,
    bad: &'a mut Block,
}

impl Kernel<Block> for Largest<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let (mut largest, mut bad) = (V::load(self.largest), V::load(self.bad));
        for eight in self.eights {
            let x = V::load(&Block(*eight));
            largest = x.max(largest);
            bad = (-x).select_gt(f64::NEG_INFINITY, bad, V::splat(1.0));
        }
        largest.store(self.largest);
        bad.store(self.bad);
    }
}

/// exp(x − `max`) of each x, and 0 where that is below e⁻⁷⁰⁸; adds to the sum of each lane.
struct Exponentials<'a> {
    of: &'a [[f64; LANES]],
    max: f64,
    out: &'a mut [[f64; LANES]],
    sums: &'a mut Block,
}

impl Kernel<Block> for Exponentials<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut sums = V::load(self.sums);
        for (eight, out) in self.of.iter().zip(&mut *self.out) {
            let x = V::load(&Block(*eight)) - V::splat(self.max);
            let y = x.select_gt(-708.0, exp(x), V::splat(0.0));
            sums = sums + y;
            let mut block = Block(*out);
            y.store(&mut block);
            *out = block.0;
        }
        sums.store(self.sums);
    }
}

/// Writes exp(x − `max`) of each x and returns their sum.
fn exponentials(of: &[f64], max: f64, out: &mut [f64]) -> f64 {
    let ((of, rest), (out, out_rest)) = (of.as_chunks(), out.as_chunks_mut());
    let (mut last, mut sums) = ([[0.0; LANES]], Block::ZERO);
    for (of, out) in [(of, out), (&[padded(rest)], &mut last)] {
        dispatch_unfused(Exponentials { of, max, out, sums: &mut sums });
    }
    out_rest.copy_from_slice(&last[0][..rest.len()]);
    sums.0.iter().sum()
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
