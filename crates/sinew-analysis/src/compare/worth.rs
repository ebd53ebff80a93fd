//! What the mean of values that hang together in time is worth.
//!
//! 1. The values are cut into at most [`BLOCKS`] equal pieces of time: what happens within a piece counts by its mean alone.
//! 2. Means x_k of the pieces are taken for a constant m and an autoregression of the first order with the correlation φ, φ = 0 or exp(−1/τ) with τ from 0.3 pieces to [`LONGEST`] of the series, evenly in log τ. With m and the scale integrated out (restricted likelihood; Harville, Biometrika 61, 1974),
//!
//! ```text
//! log p(φ | x) = −(B − 1)/2 log(1 − φ²) − 1/2 log A − (B − 1)/2 log R,   Var(m | φ) = R / ((B − 1) A)
//! A = 1 + (B − 1)(1 − φ)/(1 + φ), R the whitened sum of squares about the best m
//! ```
//!
//! 3. The variance V of the mean is the geometric mean of Var(m | φ), weighted by p, and no less than independent values have. An estimate of the correlation alone is too small in short series, since their own mean is taken off.
//! 4. The variance of a value is Σ (x − x̄)²/n + V: squares about the values' own mean lack that mean's variance.

/// Pieces at most.
const BLOCKS: usize = 30;

/// Fewer values say nothing of how they hang together, and are taken for independent.
const LEAST: usize = 8;

/// Longest time constant of the correlation, in lengths of the series, and how many are tried.
const LONGEST: f64 = 0.45;
const TRIED: usize = 25;

/// Shortest time constant, pieces.
const SHORTEST: f64 = 0.3;

/// Variance of values in the order of time, and numbers of independent ones that they are worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Worth {
    /// Variance of a value.
    pub(super) variance: f64,
    /// For their mean.
    pub(super) of_mean: f64,
    /// For their standard deviation: squares hang together for half as long.
    pub(super) of_sd: f64,
}

/// What at least two values are worth; their number where all are equal.
pub(super) fn worth(values: &[f64]) -> Worth {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    if square == 0.0 {
        return Worth { variance: 0.0, of_mean: count, of_sd: count };
    }
    let of_mean_variance = variance_of_mean(values, mean).max(square / (count - 1.0));
    let variance = square + of_mean_variance;
    let of_mean = variance / of_mean_variance;
    // Values whose correlation falls exponentially: Σ ρ = τ and Σ ρ² = (τ² + 1)/(2 τ).
    let together = count / of_mean;
    Worth { variance, of_mean, of_sd: count * 2.0 * together / (together * together + 1.0) }
}

/// Variance of the mean of values; 0 where they are too few to say.
fn variance_of_mean(values: &[f64], mean: f64) -> f64 {
    if values.len() < LEAST {
        return 0.0;
    }
    let size = values.len().div_ceil(BLOCKS);
    let count = values.len() / size;
    let first = (values.len() - count * size) / 2;
    let pieces: Vec<f64> = values[first..first + count * size]
        .chunks_exact(size)
        .map(|piece| piece.iter().sum::<f64>() / size as f64 - mean)
        .collect();
    let longest = LONGEST * count as f64;
    let at = |k: usize| match k {
        0 => 0.0,
        k => (-(SHORTEST * (longest / SHORTEST).powf((k - 1) as f64 / (TRIED - 1) as f64)).recip()).exp(),
    };
    let tried: Vec<[f64; 2]> = (0..=TRIED).map(|k| correlated(&pieces, at(k))).collect();
    let most = tried.iter().map(|[log, _]| *log).fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut total) = (0.0, 0.0);
    for [log, variance] in tried {
        let weight = (log - most).exp();
        (sum, total) = (sum + weight * variance.ln(), total + weight);
    }
    (sum / total).exp()
}

/// Logarithm of the likelihood of a correlation of neighbours, and the variance of the mean with it.
fn correlated(pieces: &[f64], correlation: f64) -> [f64; 2] {
    let free = pieces.len() as f64 - 1.0;
    let fresh = 1.0 - correlation * correlation;
    let (mut ones, mut cross, mut square) = (1.0, pieces[0], pieces[0] * pieces[0]);
    for pair in pieces.windows(2) {
        let (one, own) = (1.0 - correlation, pair[1] - correlation * pair[0]);
        ones += one * one / fresh;
        cross += one * own / fresh;
        square += own * own / fresh;
    }
    let left = (square - cross * cross / ones).max(f64::MIN_POSITIVE);
    [-0.5 * (free * fresh.ln() + ones.ln() + free * left.ln()), left / (free * ones)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and variance by the plain formulas, and all values worth themselves, where none hangs on another.
    #[test]
    fn few_and_equal_values_are_independent() {
        let found = worth(&[1.0, 4.0, 2.0, 1.0]);
        assert!((found.variance - 2.0).abs() < 1e-12, "{found:?}");
        assert!((found.of_mean - 4.0).abs() < 1e-12 && (found.of_sd - 4.0).abs() < 1e-12, "{found:?}");
        assert_eq!(worth(&[3.0; 50]), Worth { variance: 0.0, of_mean: 50.0, of_sd: 50.0 });
    }

    /// The restricted likelihood and the variance of the mean, by the inverse of the 3 × 3 correlation matrix.
    #[test]
    fn a_correlation_has_the_likelihood_of_a_normal_law() {
        let (x, r) = ([0.3, -0.5, 0.9], 0.6_f64);
        let matrix = nalgebra::Matrix3::new(1.0, r, r * r, r, 1.0, r, r * r, r, 1.0);
        let inverse = matrix.try_inverse().unwrap();
        let (ones, x3) = (nalgebra::Vector3::repeat(1.0), nalgebra::Vector3::from(x));
        let information = ones.dot(&(inverse * ones));
        let apart = x3 - ones * (ones.dot(&(inverse * x3)) / information);
        let left = apart.dot(&(inverse * apart));
        let log = -0.5 * (matrix.determinant().ln() + information.ln() + 2.0 * left.ln());
        let found = correlated(&x, r);
        assert!((found[0] - log).abs() < 1e-12 && (found[1] - left / (2.0 * information)).abs() < 1e-12, "{found:?}");
    }
}
