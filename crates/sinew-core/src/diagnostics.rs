//! What Markov chains are worth and whether they have converged: R̂, effective sample sizes, Monte Carlo standard error, E-BFMI.
//! The definitions are Stan's and ArviZ's (Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021); the tests hold ArviZ's numbers for stored chains.
//!
//! Chains are cut to their common length and halved. With W the mean variance within the halves of length n and B / n the variance of their means,
//!
//! - [`split_r_hat`]: R̂ = √(((n − 1) / n · W + B / n) / W) (Gelman et al. 2013, §11.4);
//! - [`effective_sample_size`] N_eff: N / τ with τ = 1 + 2 Σ ρ_t, where ρ_t = 1 − (W − c_t) / V with the mean autocovariance c_t within the halves and V = (n − 1) / n · W + B / n, so that chains which
//!   disagree are worth little. The sum is cut by the initial monotone sequence (Geyer 1992), and N_eff ≤ N log₁₀ N: draws that alternate are worth more than independent ones;
//! - [`mcse_of_mean`]: standard deviation of all draws over √N_eff;
//! - [`energy_fraction`]: E-BFMI = Σ (E_t − E_{t−1})² / Σ (E_t − Ē)² of one chain's energies (Betancourt 2016).
//!
//! A *rank-normalised* value is `z = Φ⁻¹((r − 3/8) / (N + 1/4))` with r its rank among all N values, ties sharing their mean rank. Then
//!
//! - [`rank_r_hat`]: the larger R̂ of the rank-normalised values and of the rank-normalised distances from the median;
//! - [`bulk_ess`]: effective sample size of the rank-normalised values;
//! - [`tail_ess`]: the smaller effective sample size of the indicators of the lowest 5 % and of the lowest 95 %.
//!
//! | input | [`effective_sample_size`] | other effective sizes | R̂ | standard error |
//! |---|---|---|---|---|
//! | a value that is not finite, fewer than 4 draws a chain | 0 | NaN | NaN | NaN |
//! | all values equal | 0 (ArviZ has N) | N | NaN | 0 |
//! | chains that stand still, apart | as computed, small | as computed | ∞ or NaN | as computed |
//! | one chain | as computed | as computed | of its halves (ArviZ has none) | as computed |
//!
//! ```
//! use sinew_core::diagnostics::{bulk_ess, rank_r_hat};
//! let away: Vec<f64> = (0..50).map(|i| f64::from(i * 17 % 50) + 40.0).collect();
//! let here: Vec<f64> = (0..50).map(|i| f64::from(i * 13 % 50)).collect();
//! assert!(rank_r_hat(&[&here, &away]) > 1.2 && bulk_ess(&[&here, &away]) < 30.0);
//! ```

use crate::estimators::{median, quantile};
use crate::lanes::LANES;
use std::cmp::Ordering;

/// Sum over the pairs of two series of one length, eight of them side by side.
fn sum(a: &[f64], b: &[f64], of: impl Fn(f64, f64) -> f64) -> f64 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += of(*a, *b));
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| of(*a, *b)).sum::<f64>()
}

/// Mean, without a sum that could overflow.
fn mean(values: &[f64]) -> f64 {
    let share = 1.0 / values.len() as f64;
    sum(values, values, |x, _| x * share)
}

/// Mean and variance, with n − 1; exact of values that are all equal.
fn moments(values: &[f64]) -> (f64, f64) {
    if values.iter().all(|&x| x == values[0]) {
        return (values[0], 0.0);
    }
    let mean = mean(values);
    (mean, sum(values, values, |x, y| (x - mean) * (y - mean)) / (values.len() as f64 - 1.0))
}

/// All draws of chains that are cut to their common length.
fn pooled<C: AsRef<[f64]>>(chains: &[C]) -> Vec<f64> {
    let length = chains.iter().map(|c| c.as_ref().len()).min().unwrap_or(0);
    chains.iter().flat_map(|c| &c.as_ref()[..length]).copied().collect()
}

/// Both halves of every chain, one after the other.
struct Halves {
    values: Vec<f64>,
    /// Draws of one half.
    length: usize,
}

impl Halves {
    /// `None` without chains, of fewer than four draws a chain, and where a draw is not finite.
    fn new<C: AsRef<[f64]>>(chains: &[C]) -> Option<Self> {
        let whole = chains.iter().map(|c| c.as_ref().len()).min()?;
        let length = whole / 2;
        let halves = chains.iter().flat_map(|c| {
            let c = &c.as_ref()[..whole];
            [&c[..length], &c[c.len() - length..]]
        });
        let values = halves.flatten().copied().collect();
        let finite = chains.iter().all(|c| c.as_ref()[..whole].iter().all(|x| x.is_finite()));
        (length >= 2 && finite).then_some(Self { values, length })
    }

    fn map(&self, of: impl Fn(f64) -> f64) -> Self {
        Self { values: self.values.iter().map(|&x| of(x)).collect(), ..*self }
    }

    fn constant(&self) -> bool {
        self.values.iter().all(|&x| x == self.values[0])
    }

    /// The values' ranks as normal deviates.
    fn rank_normalised(&self) -> Self {
        let values = &self.values;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].partial_cmp(&values[b]).unwrap_or(Ordering::Equal));
        let mut normal = vec![0.0; values.len()];
        let mut before = 0;
        for ties in order.chunk_by(|&a, &b| values[a] == values[b]) {
            let rank = before as f64 + 0.5 * (ties.len() as f64 + 1.0);
            let z = normal_quantile((rank - 0.375) / (values.len() as f64 + 0.25));
            ties.iter().for_each(|&i| normal[i] = z);
            before += ties.len();
        }
        Self { values: normal, ..*self }
    }

    fn r_hat(&self) -> f64 {
        let n = self.length as f64;
        let moments: Vec<(f64, f64)> = self.values.chunks_exact(self.length).map(moments).collect();
        let m = moments.len() as f64;
        let mean = moments.iter().map(|(mean, _)| mean / m).sum::<f64>();
        let between = moments.iter().map(|(x, _)| (x - mean) * (x - mean)).sum::<f64>() / (m - 1.0);
        let within = moments.iter().map(|(_, variance)| variance / m).sum::<f64>();
        if self.constant() { f64::NAN } else { (((n - 1.0) / n * within + between) / within).sqrt() }
    }

    fn effective(mut self) -> f64 {
        let (draws, n) = (self.values.len() as f64, self.length);
        if self.constant() {
            return draws;
        }
        let centred = |half: &mut [f64]| {
            let mean = mean(half);
            half.iter_mut().for_each(|x| *x -= mean);
            mean
        };
        let means: Vec<f64> = self.values.chunks_exact_mut(n).map(centred).collect();
        let autocovariance = |lag: usize| {
            let halves = self.values.chunks_exact(n);
            halves.map(|half| sum(&half[..n - lag], &half[lag..], |a, b| a * b)).sum::<f64>() / draws
        };
        let within = autocovariance(0) * n as f64 / (n as f64 - 1.0);
        let total = autocovariance(0) + moments(&means).1;
        let correlation = |lag: usize| 1.0 - (within - autocovariance(lag)) / total;
        let mut rho = vec![0.0; n];
        (rho[0], rho[1]) = (1.0, correlation(1));
        let (mut even, mut odd) = (rho[0], rho[1]);
        let mut t = 1;
        while t + 3 < n && even + odd > 0.0 {
            (even, odd) = (correlation(t + 1), correlation(t + 2));
            if even + odd >= 0.0 {
                (rho[t + 1], rho[t + 2]) = (even, odd);
            }
            t += 2;
        }
        // Lags before `end` count twice, `end` itself once.
        let end = t - 1;
        if even > 0.0 {
            rho[end] = even;
        }
        let mut t = 1;
        while t + 3 <= end {
            let before = rho[t - 1] + rho[t];
            if rho[t + 1] + rho[t + 2] > before {
                (rho[t + 1], rho[t + 2]) = (0.5 * before, 0.5 * before);
            }
            t += 2;
        }
        let tau = -1.0 + 2.0 * rho[..end].iter().sum::<f64>() + rho[end];
        draws / tau.max(1.0 / draws.log10())
    }
}

/// Number of independent draws whose mean errs as much as that of all draws; 0 where it does not exist, and of draws that are all equal.
#[must_use]
pub fn effective_sample_size<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    Halves::new(chains).filter(|halves| !halves.constant()).map_or(0.0, Halves::effective)
}

/// Split R̂ of the halves of all chains; NaN where it does not exist.
#[must_use]
pub fn split_r_hat<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    Halves::new(chains).map_or(f64::NAN, |halves| halves.r_hat())
}

/// Rank-normalised split R̂, of location and of scale: below 1.01 is good.
#[must_use]
pub fn rank_r_hat<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let Some(halves) = Halves::new(chains) else { return f64::NAN };
    let median = median(&mut halves.values.clone());
    let folded = halves.map(|x| (x - median).abs());
    let [location, scale] = [halves, folded].map(|values| values.rank_normalised().r_hat());
    if location.is_nan() || scale.is_nan() { f64::NAN } else { location.max(scale) }
}

/// Effective sample size for the bulk of the distribution.
#[must_use]
pub fn bulk_ess<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    Halves::new(chains).map_or(f64::NAN, |halves| halves.rank_normalised().effective())
}

/// Effective sample size for the 5 % and 95 % quantiles.
#[must_use]
pub fn tail_ess<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let Some(halves) = Halves::new(chains) else { return f64::NAN };
    let mut all = pooled(chains);
    all.sort_by(f64::total_cmp);
    let [low, high] = [0.05, 0.95].map(|p| {
        let quantile = quantile(&all, p);
        halves.map(|x| f64::from(u8::from(x <= quantile))).effective()
    });
    low.min(high)
}

/// Standard error of the mean of all draws as an estimate of the expectation.
#[must_use]
pub fn mcse_of_mean<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    Halves::new(chains).map_or(f64::NAN, |halves| (moments(&pooled(chains)).1 / halves.effective()).sqrt())
}

/// Energy Bayesian fraction of missing information of the energies of one chain; below about 0.3 the momenta explore the energies slowly. NaN where it does not exist.
#[must_use]
pub fn energy_fraction(energy: &[f64]) -> f64 {
    let n = energy.len() as f64;
    let mean = energy.iter().map(|e| e / n).sum::<f64>();
    let steps: f64 = energy.windows(2).map(|e| (e[1] - e[0]) * (e[1] - e[0])).sum();
    steps / energy.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>()
}

fn polynomial(coefficients: [f64; 8], x: f64) -> f64 {
    coefficients.into_iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// Φ⁻¹, by the rational approximations PPND16 (Wichura 1988, AS 241), exact to about 1e-16.
fn normal_quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * polynomial(CENTRE[0], r) / polynomial(CENTRE[1], r);
    }
    let r = (-p.min(1.0 - p).ln()).sqrt();
    let [numerator, denominator] = if r <= 5.0 { MIDDLE } else { FAR };
    let r = if r <= 5.0 { r - 1.6 } else { r - 5.0 };
    (polynomial(numerator, r) / polynomial(denominator, r)).copysign(q)
}

const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_5,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
];
const MIDDLE: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_758_7,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];
const FAR: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_9,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Block, Isa};
    use crate::random::Stage;

    /// A stationary first-order chain x' = φ x + √(1 − φ²) e.
    fn ar1(phi: f64, length: usize, stage: Stage) -> Vec<f64> {
        let mut noise = vec![Block::ZERO; length.div_ceil(8)];
        stage.whole().fill_normal(Isa::best(), &mut noise);
        let mut x = 0.0;
        let fresh = (1.0 - phi * phi).sqrt();
        noise
            .iter()
            .flat_map(|b| b.0)
            .take(length)
            .enumerate()
            .map(|(i, e)| {
                x = if i == 0 { e } else { phi * x + fresh * e };
                x
            })
            .collect()
    }

    /// τ = (1 + φ) / (1 − φ), for chains that alternate too.
    #[test]
    fn first_order_chains_are_worth_what_their_autocorrelation_says() {
        for (phi, seed) in [(-0.5, 4), (0.0, 1), (0.5, 2), (0.9, 3)] {
            let length = 1_000_000;
            let worth = effective_sample_size(&[ar1(phi, length, Stage::new(seed, "H11"))]);
            let exact = length as f64 * (1.0 - phi) / (1.0 + phi);
            assert!((worth / exact - 1.0).abs() < 0.1, "phi {phi}: {worth} against {exact} ± 10 %");
        }
    }

    #[test]
    fn chains_of_one_distribution_have_r_hat_near_one_and_shifted_ones_do_not() {
        let root = Stage::new(5, "r hat");
        let mut chains: Vec<Vec<f64>> = (0..4).map(|i| ar1(0.3, 2000, root.round(i))).collect();
        let together = split_r_hat(&chains);
        assert!((together - 1.0).abs() < 0.01, "{together}");
        chains[2].iter_mut().for_each(|x| *x += 1.0);
        assert!(split_r_hat(&chains) > 1.05);
        let constant = vec![0.1; 2000];
        assert!(split_r_hat(&[chains[0].clone(), chains[1].clone(), chains[3].clone(), constant]) > 1.0);
    }

    #[test]
    fn r_hat_matches_its_formula_by_hand() {
        // Halves (0, 2), (1, 3): means 1, 2; W = 2; B / n = 0.5; n = 2.
        assert!((split_r_hat(&[[0.0, 2.0, 1.0, 3.0]]) - ((0.5 * 2.0 + 0.5) / 2.0_f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn quantiles_of_the_normal_distribution() {
        for (p, z) in [(0.5, 0.0), (0.975, 1.959_963_984_540_054), (0.1, -1.281_551_565_544_600_4)] {
            assert!((normal_quantile(p) - z).abs() < 1e-14, "{p}");
        }
        assert!((normal_quantile(1e-20) + 9.262_340_089_798_408).abs() < 1e-12);
        assert!((normal_quantile(0.01) + normal_quantile(0.99)).abs() < 1e-13);
    }

    #[test]
    fn answers_are_defined_where_the_quantity_is_not() {
        let short = [[1.0, 2.0, 3.0]; 2];
        let broken = [[1.0, f64::NAN, 3.0, 4.0]; 2];
        let infinite = [[1.0, f64::INFINITY, 2.0, 3.0, 4.0]; 2];
        let none: [&[f64]; 0] = [];
        for chains in
            [short.each_ref().map(|c| &c[..]), broken.each_ref().map(|c| &c[..]), infinite.each_ref().map(|c| &c[..])]
                .iter()
                .map(|c| &c[..])
                .chain([&none[..]])
        {
            assert_eq!(effective_sample_size(chains), 0.0, "{chains:?}");
            let others =
                [split_r_hat(chains), rank_r_hat(chains), bulk_ess(chains), tail_ess(chains), mcse_of_mean(chains)];
            assert!(others.iter().all(|x| x.is_nan()), "{chains:?}: {others:?}");
        }
        // Chains that stand still have no spread to compare with, wherever they stand.
        assert!(split_r_hat(&[[1.0; 8], [2.0; 8]]).is_infinite() && rank_r_hat(&[[1.0; 10], [2.0; 10]]).is_nan());
        // Two values only: they have a location and no scale.
        assert!(rank_r_hat(&[[1.0, -1.0, 1.0, -1.0, -1.0, 1.0]; 2]).is_nan());
        // A mean of 0.1 that is added up is not 0.1.
        let constant = [[0.1; 10]; 3];
        assert!(rank_r_hat(&constant).is_nan() && split_r_hat(&constant).is_nan());
        assert_eq!((bulk_ess(&constant), mcse_of_mean(&constant), effective_sample_size(&constant)), (30.0, 0.0, 0.0));
    }

    #[test]
    fn energy_fraction_of_independent_energies_is_two() {
        let fraction = energy_fraction(&ar1(0.0, 100_000, Stage::new(8, "energy")));
        assert!((fraction - 2.0).abs() < 0.05, "{fraction}");
        assert!(energy_fraction(&[]).is_nan());
    }
}
