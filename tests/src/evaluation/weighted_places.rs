//! Where a truth falls among weighted draws, coordinate by coordinate.

use sinew::tracking::posterior::Posterior;

/// Share of the weight that lies on draws below the truth, u = Σ W_i 1(s_i < truth), for each coordinate.
#[must_use]
pub fn weighted_places(posterior: &Posterior<'_>, truth: &[f64]) -> Vec<f64> {
    summed(posterior, |j, x| if x < truth[j] { 1.0 } else { 0.0 })
}

/// Standard deviation of each coordinate about the given mean of the draws.
#[must_use]
pub fn spreads(posterior: &Posterior<'_>, mean: &[f64]) -> Vec<f64> {
    summed(posterior, |j, x| (x - mean[j]).powi(2)).into_iter().map(f64::sqrt).collect()
}

/// Whether the central interval of a level, 0 to 1, holds a truth at that place.
#[must_use]
pub fn is_inside(place: f64, level: f64) -> bool {
    (place - 0.5).abs() < 0.5 * level
}

/// Weighted sums of a function of each coordinate.
fn summed(posterior: &Posterior<'_>, of: impl Fn(usize, f64) -> f64) -> Vec<f64> {
    let mut state = vec![0.0; posterior.dim];
    let mut sums = vec![0.0; posterior.dim];
    for (i, &weight) in posterior.weights.iter().enumerate() {
        posterior.state(i, &mut state);
        sums.iter_mut().zip(&state).enumerate().for_each(|(j, (sum, x))| *sum += weight * of(j, *x));
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::core::lanes::Block;

    #[test]
    fn weights_below_the_truth_are_added() {
        let states = [Block([0.0, 1.0, 2.0, 3.0, 9.0, 9.0, 9.0, 9.0]), Block([3.0, 2.0, 1.0, 0.0, 9.0, 9.0, 9.0, 9.0])];
        let weights = [0.1, 0.2, 0.3, 0.4];
        let posterior = Posterior { dim: 2, states: &states, weights: &weights, effective: 4.0, chain_stats: &[] };
        let places = weighted_places(&posterior, &[1.5, 1.5]);
        assert!((places[0] - 0.3).abs() < 1e-12 && (places[1] - 0.7).abs() < 1e-12, "{places:?}");
        // Mean 2, variance 0.1 · 4 + 0.2 · 1 + 0.4 · 1.
        let spread = spreads(&posterior, &[2.0, 1.0]);
        assert!(spread.iter().all(|sd| (sd - 1.0).abs() < 1e-12), "{spread:?}");
    }

    #[test]
    fn central_intervals_hold_the_middle() {
        assert!(is_inside(0.5, 0.1) && is_inside(0.06, 0.9) && !is_inside(0.04, 0.9) && !is_inside(0.96, 0.9));
    }
}
