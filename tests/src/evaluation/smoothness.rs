//! How smooth estimates are over time.

/// Mean over coordinates of the absolute second differences, frame by frame from the third on. `difference(j, a, b)` is a − b in coordinate j, which a coordinate that wraps takes the short way round.
#[must_use]
pub fn second_differences(states: &[Vec<f64>], difference: impl Fn(usize, f64, f64) -> f64) -> Vec<f64> {
    let change = |pair: &[Vec<f64>], j: usize| difference(j, pair[1][j], pair[0][j]);
    let mean = |three: &[Vec<f64>]| {
        let second = |j: usize| difference(j, change(&three[1..], j), change(&three[..2], j)).abs();
        (0..three[0].len()).map(second).sum::<f64>() / three[0].len() as f64
    };
    states.windows(3).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn second_differences_match_a_parabola() {
        let states: Vec<Vec<f64>> = (0..5).map(|t| vec![0.02 * f64::from(t * t); 4]).collect();
        let found = second_differences(&states, |_, a, b| a - b);
        assert!(found.len() == 3 && found.iter().all(|x| (x - 0.04).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn coordinates_that_wrap_are_smooth_where_they_turn_round() {
        let turn = |t: u8| vec![(0.8 * f64::from(t)).rem_euclid(std::f64::consts::TAU)];
        let states: Vec<Vec<f64>> = (0..12).map(turn).collect();
        let short = |_: usize, a: f64, b: f64| (a - b).sin().atan2((a - b).cos());
        assert!(second_differences(&states, short).iter().all(|x| *x < 1e-12));
    }
}
