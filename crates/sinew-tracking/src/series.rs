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

/// The k-th least number of a series, from 0, times `sign`. It is looked for below `bound`, where few are; where too few are, everywhere.
fn kth_least(series: &[f64], sign: f64, k: usize, bound: f64, below: &mut Vec<f64>) -> f64 {
    below.clear();
    below.resize(series.len(), 0.0);
    let mut count = 0;
    for x in series {
        below[count] = sign * x;
        count += usize::from(sign * x < bound);
    }
    if count <= k {
        count = series.len();
        below.iter_mut().zip(series).for_each(|(to, x)| *to = sign * x);
    }
    *below[..count].select_nth_unstable_by(k, f64::total_cmp).1
}

/// Mean, standard deviation, 5 % and 95 % quantile of a series, which is not empty.
#[must_use]
pub fn describe(series: &[f64], weights: &[f64], equal: bool) -> [f64; 4] {
    let [mean, sd] = moments(series, weights, equal);
    let [low, high] = if equal {
        let n = series.len();
        let at = |p: f64| ((p * n as f64).ceil() as usize).clamp(1, n) - 1;
        let mut below = vec![];
        let low = kth_least(series, 1.0, at(0.05), mean - sd, &mut below);
        let high = -kth_least(series, -1.0, n - 1 - at(0.95), -(mean + sd), &mut below);
        [low, high]
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
        let series: Vec<f64> = (0..100).map(|i| f64::from(i * 37 % 100)).collect();
        let weights = vec![0.01; 100];
        let weighted = describe(&series, &weights, false);
        assert_eq!(describe(&series, &weights, true)[2..], [4.0, 94.0]);
        assert!((weighted[0] - 49.5).abs() < 1e-12);
        assert!((weighted[2] - 4.0).abs() <= 1.0 && (weighted[3] - 94.0).abs() <= 1.0);
    }

    #[test]
    fn one_heavy_draw_is_all_there_is() {
        let described = describe(&[1.0, 5.0, 2.0], &[0.0, 1.0, 0.0], false);
        assert_eq!(described, [5.0, 0.0, 5.0, 5.0]);
    }

    /// Also of series with nothing below the mean less one standard deviation, few numbers, and equal ones.
    #[test]
    fn quantiles_agree_with_the_sorted_series() {
        let power =
            |exponent: i32| (1..=400).map(move |i| f64::from(i * 171 % 401).powi(exponent)).collect::<Vec<f64>>();
        let mirrored = power(9).iter().map(|x| -x).collect();
        for series in [power(1), power(9), mirrored, power(0), vec![3.0, -1.0], vec![2.5]] {
            let mut sorted = series.clone();
            sorted.sort_by(f64::total_cmp);
            let n = series.len();
            let at = |p: f64| sorted[((p * n as f64).ceil() as usize).max(1) - 1];
            let [.., low, high] = describe(&series, &vec![1.0 / n as f64; n], true);
            assert_eq!([low, high], [at(0.05), at(0.95)], "{n} numbers, {:?} …", &sorted[..1]);
        }
    }
}
