//! Mean, spread and quantiles of one number over weighted draws.
//!
//! Quantiles are the least value at which the cumulated weight reaches p.

use sinew_core::lanes::LANES;

/// Sum over a series, eight numbers side by side.
fn sum(series: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    let (eights, rest) = series.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for eight in eights {
        sums.iter_mut().zip(eight).for_each(|(sum, x)| *sum += of(*x));
    }
    sums.iter().sum::<f64>() + rest.iter().map(|x| of(*x)).sum::<f64>()
}

/// Mean and standard deviation of a series.
#[must_use]
pub fn moments(series: &[f64], weights: &[f64], equal: bool) -> [f64; 2] {
    if equal {
        let count = series.len() as f64;
        let mean = sum(series, |x| x) / count;
        return [mean, (sum(series, |x| (x - mean) * (x - mean)) / count).sqrt()];
    }
    let mean: f64 = series.iter().zip(weights).map(|(x, w)| w * x).sum();
    let variance: f64 = series.iter().zip(weights).map(|(x, w)| w * (x - mean) * (x - mean)).sum();
    [mean, variance.max(0.0).sqrt()]
}

/// Mean, standard deviation, 5 % and 95 % quantile of a series; reorders it where the weights are equal.
#[must_use]
pub fn describe(series: &mut [f64], weights: &[f64], equal: bool) -> [f64; 4] {
    let [mean, sd] = moments(series, weights, equal);
    let [low, high] = if equal {
        let n = series.len();
        let at = |p: f64| ((p * n as f64).ceil() as usize).clamp(1, n) - 1;
        let (low, high) = (at(0.05), at(0.95));
        let (left, &mut high_value, _) = series.select_nth_unstable_by(high, f64::total_cmp);
        let low_value = if low < high { *left.select_nth_unstable_by(low, f64::total_cmp).1 } else { high_value };
        [low_value, high_value]
    } else {
        let mut order: Vec<(f64, f64)> = series.iter().copied().zip(weights.iter().copied()).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        [0.05, 0.95].map(|p| {
            let mut sum = 0.0;
            let reached = order.iter().find(|(_, w)| {
                sum += w;
                sum >= p
            });
            reached.or(order.last()).map_or(mean, |(x, _)| *x)
        })
    };
    [mean, sd, low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_equal_and_of_given_weights_agree() {
        let mut series: Vec<f64> = (0..100).map(|i| f64::from(i * 37 % 100)).collect();
        let weights = vec![0.01; 100];
        let weighted = describe(&mut series.clone(), &weights, false);
        assert_eq!(describe(&mut series, &weights, true)[2..], [4.0, 94.0]);
        assert!((weighted[0] - 49.5).abs() < 1e-12);
        assert!((weighted[2] - 4.0).abs() <= 1.0 && (weighted[3] - 94.0).abs() <= 1.0);
    }

    #[test]
    fn one_heavy_draw_is_all_there_is() {
        let described = describe(&mut [1.0, 5.0, 2.0], &[0.0, 1.0, 0.0], false);
        assert_eq!(described, [5.0, 0.0, 5.0, 5.0]);
    }
}
