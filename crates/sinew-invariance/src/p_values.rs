//! Two-sided p-values of the statistics used here.

use statrs::distribution::{Binomial, ChiSquared, ContinuousCDF, DiscreteCDF, Normal};

/// Of a standard normal z-score.
pub(crate) fn normal_p(z: f64) -> f64 {
    Normal::standard().sf(z.abs()) * 2.0
}

/// Of a χ² with that many degrees of freedom, to the right.
pub(crate) fn chi_square_p(value: f64, freedom: usize) -> f64 {
    ChiSquared::new(freedom as f64).map_or(f64::NAN, |law| law.sf(value))
}

/// Of `up` rises among `up + down` changes that go either way with equal probability, exactly; 1 where nothing changed.
pub(crate) fn signs_p(up: u64, down: u64) -> f64 {
    let changes = up + down;
    Binomial::new(0.5, changes).map_or(f64::NAN, |law| (2.0 * law.cdf(up.min(down))).min(1.0))
}

/// Of a share among `draws` independent events of this probability, by the binomial law of their rounded count.
pub(crate) fn share_p(share: f64, draws: f64, probability: f64) -> f64 {
    let (draws, count) = (draws.round().max(1.0), (share * draws).round());
    Binomial::new(probability, draws as u64).map_or(f64::NAN, |law| {
        let below = law.cdf(count as u64);
        let above = if count > 0.0 { law.sf(count as u64 - 1) } else { 1.0 };
        (2.0 * below.min(above)).min(1.0)
    })
}

/// χ² of counts against equal expectations, with its p-value.
pub(crate) fn uniform_counts(counts: &[u64]) -> (f64, f64) {
    against_expected(counts, &vec![1; counts.len()])
}

/// χ² of counts against expectations in these proportions, with its p-value.
pub(crate) fn against_expected(counts: &[u64], proportions: &[u64]) -> (f64, f64) {
    let sum = |of: &[u64]| of.iter().sum::<u64>() as f64;
    let scale = sum(counts) / sum(proportions);
    let one = |(&c, &p): (&u64, &u64)| (c as f64 - scale * p as f64).powi(2) / (scale * p as f64);
    let value = counts.iter().zip(proportions).map(one).sum();
    (value, chi_square_p(value, counts.len() - 1))
}

/// Largest distance D between two empirical distribution functions, with the p-value of Kolmogorov's limit law at (√n + 0.12 + 0.11 / √n) D (Stephens 1970), n = ab / (a + b).
/// Ties are taken together, which makes the p-value too large, never too small.
pub(crate) fn two_samples(a: &mut [f64], b: &mut [f64]) -> (f64, f64) {
    if a.iter().chain(&*b).any(|x| x.is_nan()) {
        return (f64::NAN, f64::NAN);
    }
    a.sort_by(f64::total_cmp);
    b.sort_by(f64::total_cmp);
    let (mut i, mut j, mut distance) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        let x = a[i].min(b[j]);
        i += a[i..].iter().take_while(|&&y| y == x).count();
        j += b[j..].iter().take_while(|&&y| y == x).count();
        distance = distance.max((i as f64 / a.len() as f64 - j as f64 / b.len() as f64).abs());
    }
    let root = ((a.len() * b.len()) as f64 / (a.len() + b.len()) as f64).sqrt();
    (distance, kolmogorov_p((root + 0.12 + 0.11 / root) * distance))
}

/// P(K > x) of Kolmogorov's distribution: 2 Σ (−1)^(k−1) exp(−2 k² x²).
pub(crate) fn kolmogorov_p(x: f64) -> f64 {
    if x < 0.2 {
        return 1.0;
    }
    let term = |k: i32| f64::from(1 - 2 * ((k + 1) % 2)) * (-2.0 * f64::from(k * k) * x * x).exp();
    (2.0 * (1..=40).map(term).sum::<f64>()).clamp(0.0, 1.0)
}

/// Mean over the standard error of the mean, with its p-value; a sample that is all zero has 0 and 1.
pub(crate) fn mean_is_zero(sum: f64, square: f64, count: usize) -> (f64, f64) {
    if square == 0.0 {
        return (0.0, 1.0);
    }
    let n = count as f64;
    let mean = sum / n;
    let z = mean / ((square / n - mean * mean).max(0.0) / (n - 1.0)).sqrt();
    (z, normal_p(z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_match_tables() {
        assert!((normal_p(1.959_964) - 0.05).abs() < 1e-6);
        assert!((normal_p(-5.326_724) / 1e-7 - 1.0).abs() < 1e-4);
        assert!((chi_square_p(30.143_527, 19) - 0.05).abs() < 1e-6);
        assert!((kolmogorov_p(1.358_099) - 0.05).abs() < 1e-5);
        assert!((kolmogorov_p(0.571_173) - 0.9).abs() < 1e-4);
        assert!((signs_p(0, 5) - 0.0625).abs() < 1e-12);
        assert_eq!(signs_p(0, 0), 1.0);
        assert_eq!(signs_p(4, 4), 1.0);
        // P(X ≥ 3) and P(X = 0) of ten throws at 0.1, twice; a share that no probability explains.
        assert!((share_p(0.3, 10.0, 0.1) - 2.0 * 0.070_190_826_4).abs() < 1e-9);
        assert!((share_p(0.0, 10.0, 0.1) - 2.0 * 0.348_678_440_1).abs() < 1e-9);
        assert_eq!(share_p(0.1, 10.0, 0.1), 1.0);
        assert!(share_p(0.1, 10.0, 0.0) < 1e-300 && share_p(0.1, 10.0, 1.1).is_nan());
    }

    #[test]
    fn samples_that_agree_or_tie_are_no_alarm() {
        let mut a: Vec<f64> = (0..100).map(f64::from).collect();
        let mut b = a.clone();
        assert_eq!(two_samples(&mut a, &mut b), (0.0, 1.0));
        let mut c: Vec<f64> = (1000..1100).map(f64::from).collect();
        let (distance, p) = two_samples(&mut a, &mut c);
        assert!(distance == 1.0 && p < 1e-40, "{p}");
        assert!(two_samples(&mut [1.0, f64::NAN], &mut b).1.is_nan());
    }
}
