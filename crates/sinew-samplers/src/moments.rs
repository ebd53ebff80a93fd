//! Mean, covariance and a covariance shrunk towards its diagonal, of weighted states in blocks.
//!
//! m = Σ W_i s_i and C = Σ W_i (s_i − m)(s_i − m)ᵀ / (1 − 1 / n_eff), where n_eff is the effective number of draws (1 / Σ W² of independent weighted states, n / τ of chains).
//!
//! Shrinkage: C ← (n_eff C + n₀ diag C) / (n_eff + n₀) with n₀ = d pseudo-draws, so the off-diagonal entries are multiplied by 1 − λ, λ = d / (n_eff + d). Variances are not touched ([`crate::metric::Metric::shrink`] does the same in the axes of a metric), and the result is positive
//! definite where all of them are positive. A λ fitted to the correlations (Schäfer & Strimmer 2005) is twice as large where there are many weak ones: in a linear-Gaussian filter of ten dimensions, with 464
//! draws a frame, it pulled means by up to 0.18 posterior standard deviations, away from the exact filter and the same way in every run.

use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::transition::Moments;

/// Weighted mean of `weights.len()` states; the weights add up to 1.
#[must_use]
pub fn mean(states: &[Block], dim: usize, weights: &[f64]) -> Vec<f64> {
    let mut sum = vec![Block::ZERO; dim];
    for_each_block(states, dim, weights, |states, w| {
        for (sum, x) in sum.iter_mut().zip(states) {
            let mut next = sum.0;
            for lane in 0..LANES {
                next[lane] += w[lane] * x.0[lane];
            }
            sum.0 = next;
        }
    });
    sum.iter().map(|b| b.0.iter().sum()).collect()
}

/// What makes the variance of draws that are worth `effective` independent ones unbiased.
fn correction(effective: f64) -> f64 {
    if effective > 1.0 { 1.0 / (1.0 - 1.0 / effective) } else { 1.0 }
}

/// Standard deviations of the coordinates of `weights.len()` states that are worth `effective` independent ones, about their mean.
#[must_use]
pub fn standard_deviations(states: &[Block], mean: &[f64], weights: &[f64], effective: f64) -> Vec<f64> {
    let mut sums = vec![Block::ZERO; mean.len()];
    for_each_block(states, mean.len(), weights, |states, w| {
        for ((sum, x), m) in sums.iter_mut().zip(states).zip(mean) {
            let mut next = sum.0;
            for lane in 0..LANES {
                next[lane] += w[lane] * (x.0[lane] - m) * (x.0[lane] - m);
            }
            sum.0 = next;
        }
    });
    sums.iter().map(|b| (correction(effective) * b.0.iter().sum::<f64>()).sqrt()).collect()
}

/// Calls a function of each block of states and its weights; lanes beyond the last state have the weight 0.
#[inline]
fn for_each_block(states: &[Block], dim: usize, weights: &[f64], mut each: impl FnMut(&[Block], &[f64; LANES])) {
    let (eights, rest) = weights.as_chunks();
    let (full, last) = states.split_at(states.len().min(eights.len() * dim));
    full.chunks_exact(dim).zip(eights).for_each(|(states, weights)| each(states, weights));
    if !rest.is_empty() {
        let mut weights = [0.0; LANES];
        weights[..rest.len()].copy_from_slice(rest);
        each(last, &weights);
    }
}

struct Outer<'a> {
    states: &'a [Block],
    weight: &'a Block,
    mean: &'a [f64],
    centred: &'a mut [Block],
    sum: &'a mut [Block],
}

impl Kernel<Block> for Outer<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.mean.len();
        let (states, centred) = (&self.states[..d], &mut self.centred[..d]);
        let w = V::load(self.weight);
        let mut row = &mut self.sum[..];
        for i in 0..d {
            let x = V::load(&states[i]) - V::splat(self.mean[i]);
            x.store(&mut centred[i]);
            let wx = x * w;
            let (this, rest) = row.split_at_mut(i + 1);
            row = rest;
            for (s, c) in this.iter_mut().zip(&*centred) {
                wx.fma(V::load(c), V::load(s)).store(s);
            }
        }
    }
}

/// Mean and covariance of `weights.len()` states that are worth `effective` independent ones.
#[must_use]
pub fn moments(isa: Isa, states: &[Block], dim: usize, weights: &[f64], effective: f64) -> Moments {
    let mean = mean(states, dim, weights);
    let mut sum = vec![Block::ZERO; dim * (dim + 1) / 2];
    let mut centred = vec![Block::ZERO; dim];
    for_each_block(states, dim, weights, |states, weights| {
        let weight = &Block(*weights);
        dispatch(isa, Outer { states, weight, mean: &mean, centred: &mut centred, sum: &mut sum });
    });
    let unbiased = correction(effective);
    let mut covariance = vec![0.0; dim * dim];
    let mut entries = sum.iter().map(|b| unbiased * b.0.iter().sum::<f64>());
    for i in 0..dim {
        for (j, entry) in (0..=i).zip(&mut entries) {
            covariance[i * dim + j] = entry;
            covariance[j * dim + i] = entry;
        }
    }
    Moments { mean, covariance }
}

/// Shrinks the covariance of `effective` independent draws towards its diagonal and returns λ; without draws only the diagonal is left.
pub fn shrink(moments: &mut Moments, effective: f64) -> f64 {
    let d = moments.mean.len();
    let lambda = d as f64 / (effective.max(0.0) + d as f64);
    for (k, entry) in moments.covariance.iter_mut().enumerate() {
        if k / d != k % d {
            *entry *= 1.0 - lambda;
        }
    }
    lambda
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_match_the_sums_written_out() {
        let states: Vec<[f64; 2]> = (0..11).map(|i| [f64::from(i * i % 7), f64::from(i) - 3.0]).collect();
        let raw: Vec<f64> = (0..11).map(|i| f64::from(1 + i % 3)).collect();
        let total: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / total).collect();
        let mut blocks = vec![Block::splat(1e9); 4];
        for (i, s) in states.iter().enumerate() {
            blocks[i / LANES * 2].0[i % LANES] = s[0];
            blocks[i / LANES * 2 + 1].0[i % LANES] = s[1];
        }
        let effective = crate::weights::effective_number(&weights);
        for isa in Isa::available() {
            let got = moments(isa, &blocks, 2, &weights, effective);
            let mean = |k: usize| states.iter().zip(&weights).map(|(s, w)| w * s[k]).sum::<f64>();
            let cov = |k: usize, l: usize| {
                states.iter().zip(&weights).map(|(s, w)| w * (s[k] - mean(k)) * (s[l] - mean(l))).sum::<f64>()
                    / (1.0 - 1.0 / effective)
            };
            assert!((got.mean[1] - mean(1)).abs() < 1e-13);
            let sds = standard_deviations(&blocks, &got.mean, &weights, effective);
            assert!((0..2).all(|k| (sds[k] - cov(k, k).sqrt()).abs() < 1e-13));
            for (k, l) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                assert!((got.covariance[k * 2 + l] - cov(k, l)).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn shrinkage_falls_with_the_number_of_draws_and_leaves_variances() {
        let start = || Moments { mean: vec![0.0; 2], covariance: vec![4.0, 1.0, 1.0, 1.0] };
        let (mut few, mut many, mut none) = (start(), start(), start());
        let lambdas = (shrink(&mut few, 18.0), shrink(&mut many, 1998.0), shrink(&mut none, 0.0));
        assert_eq!(lambdas, (0.1, 0.001, 1.0));
        assert_eq!((few.covariance[0], few.covariance[3]), (4.0, 1.0));
        assert_eq!(few.covariance[1], 1.0 - lambdas.0);
        assert_eq!(none.covariance[1], 0.0);
    }
}
