//! Whether chains have converged: rank-normalised split R̂, effective sample sizes and Monte Carlo standard error.
//! The definitions are Stan's and ArviZ's (Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021); effective sample sizes are of the bulk and of the tails.
//!
//! Chains are halved. A *rank-normalised* value is `z = Φ⁻¹((r − 3/8) / (S + 1/4))` with r its rank among all S values, ties sharing their mean rank. Then
//!
//! - [`rank_r_hat`]: the larger R̂ of the rank-normalised values and of the rank-normalised distances from the median;
//! - [`bulk_ess`]: effective sample size of the rank-normalised values;
//! - [`tail_ess`]: the smaller effective sample size of the indicators of the lowest 5 % and of the lowest 95 %;
//! - [`mcse_of_mean`]: standard deviation over the root of the effective sample size of the values themselves.
//!
//! Effective sample sizes combine the autocovariances of the halves with the variance between their means, so that chains which disagree are worth little; the sum is cut by Geyer's
//! initial monotone sequence. Chains are cut to their common length. Where a value is not finite or a chain has fewer than four draws, the answer is NaN; where all values are equal, the
//! effective sample size is their number and R̂ is NaN. The tests hold the numbers of ArviZ for chains that are stored beside them.
//!
//! [`crate::diagnostics`] has the plain versions that the trackers compute in every frame.
//!
//! ```
//! use sinew_core::convergence::{bulk_ess, rank_r_hat};
//! let away: Vec<f64> = (0..50).map(|i| f64::from(i * 17 % 50) + 40.0).collect();
//! let here: Vec<f64> = (0..50).map(|i| f64::from(i * 13 % 50)).collect();
//! assert!(rank_r_hat(&[&here, &away]) > 1.2 && bulk_ess(&[&here, &away]) < 30.0);
//! ```

use crate::estimators::{mean, median, quantile, variance};
use std::cmp::Ordering;

/// Both halves of every chain, cut to their common length; `None` where nothing can be said.
fn halves<C: AsRef<[f64]>>(chains: &[C]) -> Option<Vec<Vec<f64>>> {
    let length = chains.iter().map(|c| c.as_ref().len()).min()?;
    let half = length / 2;
    let finite = chains.iter().all(|c| c.as_ref()[..length].iter().all(|x| x.is_finite()));
    let halves = |c: &C| [c.as_ref()[..half].to_vec(), c.as_ref()[length - half..length].to_vec()];
    (length >= 4 && finite).then(|| chains.iter().flat_map(halves).collect())
}

/// The values' ranks as normal deviates.
fn rank_normalised(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let length = chains.first().map_or(0, Vec::len);
    let values: Vec<f64> = chains.iter().flatten().copied().collect();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].partial_cmp(&values[b]).unwrap_or(Ordering::Equal));
    let mut out = vec![0.0; values.len()];
    for ties in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let before = order.partition_point(|&i| values[i] < values[ties[0]]) as f64;
        let rank = before + 0.5 * (ties.len() as f64 + 1.0);
        let z = normal_quantile((rank - 0.375) / (values.len() as f64 + 0.25));
        ties.iter().for_each(|&i| out[i] = z);
    }
    out.chunks(length.max(1)).map(<[f64]>::to_vec).collect()
}

fn r_hat(chains: &[Vec<f64>]) -> f64 {
    let n = chains.first().map_or(0, Vec::len) as f64;
    let means: Vec<f64> = chains.iter().map(|c| mean(c)).collect();
    let within = chains.iter().map(|c| variance(c)).sum::<f64>() / chains.len() as f64;
    if within > 0.0 { ((n * variance(&means) / within + n - 1.0) / n).sqrt() } else { f64::NAN }
}

/// Effective sample size of chains that are halved already.
fn effective(chains: &[Vec<f64>]) -> f64 {
    let (m, n) = (chains.len() as f64, chains.first().map_or(0, Vec::len));
    let all = || chains.iter().flatten().copied();
    let range = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
    if range < 1e-15 {
        return m * n as f64;
    }
    let means: Vec<f64> = chains.iter().map(|c| mean(c)).collect();
    let autocovariance = |lag: usize| {
        let of = |(c, mean): (&Vec<f64>, &f64)| {
            c.iter().zip(&c[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / n as f64
        };
        chains.iter().zip(&means).map(of).sum::<f64>() / m
    };
    let within = autocovariance(0) * n as f64 / (n as f64 - 1.0);
    let between = if chains.len() > 1 { variance(&means) } else { 0.0 };
    let total = within * (n as f64 - 1.0) / n as f64 + between;
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
    let draws = m * n as f64;
    let tau = -1.0 + 2.0 * rho[..end].iter().sum::<f64>() + rho[end];
    draws / tau.max(1.0 / draws.log10())
}

/// Rank-normalised split R̂, of location and of scale: below 1.01 is good.
#[must_use]
pub fn rank_r_hat<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let Some(halves) = halves(chains) else { return f64::NAN };
    let median = median(&mut halves.concat());
    let folded: Vec<Vec<f64>> = halves.iter().map(|c| c.iter().map(|x| (x - median).abs()).collect()).collect();
    let [location, scale] = [&halves, &folded].map(|values| r_hat(&rank_normalised(values)));
    if location.is_nan() || scale.is_nan() { f64::NAN } else { location.max(scale) }
}

/// Effective sample size for the bulk of the distribution.
#[must_use]
pub fn bulk_ess<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    halves(chains).map_or(f64::NAN, |halves| effective(&rank_normalised(&halves)))
}

/// Effective sample size for the 5 % and 95 % quantiles.
#[must_use]
pub fn tail_ess<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let length = chains.iter().map(|c| c.as_ref().len()).min().unwrap_or(0);
    let mut all: Vec<f64> = chains.iter().flat_map(|c| &c.as_ref()[..length]).copied().collect();
    all.sort_by(f64::total_cmp);
    let Some(halves) = halves(chains) else { return f64::NAN };
    let of = |p: f64| {
        let quantile = quantile(&all, p);
        let below = |c: &Vec<f64>| c.iter().map(|x| f64::from(u8::from(*x <= quantile))).collect();
        effective(&halves.iter().map(below).collect::<Vec<_>>())
    };
    of(0.05).min(of(0.95))
}

/// Standard error of the mean of all draws as an estimate of the expectation.
#[must_use]
pub fn mcse_of_mean<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let length = chains.iter().map(|c| c.as_ref().len()).min().unwrap_or(0);
    let Some(halves) = halves(chains) else { return f64::NAN };
    let all: Vec<f64> = chains.iter().flat_map(|c| &c.as_ref()[..length]).copied().collect();
    (variance(&all) / effective(&halves)).sqrt()
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

    #[test]
    fn quantiles_of_the_normal_distribution() {
        for (p, z) in [(0.5, 0.0), (0.975, 1.959_963_984_540_054), (0.1, -1.281_551_565_544_600_4)] {
            assert!((normal_quantile(p) - z).abs() < 1e-14, "{p}");
        }
        assert!((normal_quantile(1e-20) + 9.262_340_089_798_408).abs() < 1e-12);
        assert!((normal_quantile(0.01) + normal_quantile(0.99)).abs() < 1e-13);
    }

    #[test]
    fn where_nothing_can_be_said_nothing_is() {
        let short = [[1.0, 2.0, 3.0]; 2];
        assert!(rank_r_hat(&short).is_nan() && bulk_ess(&short).is_nan() && tail_ess(&short).is_nan());
        let broken = [[1.0, f64::NAN, 3.0, 4.0]; 2];
        assert!(rank_r_hat(&broken).is_nan() && mcse_of_mean(&broken).is_nan());
        assert!(rank_r_hat::<[f64; 0]>(&[]).is_nan());
        // Chains that stand still have no spread to compare with, wherever they stand.
        assert!(rank_r_hat(&[[1.0; 10], [2.0; 10]]).is_nan());
        // Two values only: they have a location and no scale.
        assert!(rank_r_hat(&[[1.0, -1.0, 1.0, -1.0, -1.0, 1.0]; 2]).is_nan());
        let constant = [[2.0; 10]; 3];
        assert!(rank_r_hat(&constant).is_nan());
        assert_eq!((bulk_ess(&constant), mcse_of_mean(&constant)), (30.0, 0.0));
    }
}
