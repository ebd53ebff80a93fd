//! A number with its draws, and what follows from them.

use sinew_core::estimators::quantile;

/// A number and the same number in every draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Varied {
    /// From the means.
    pub mean: f64,
    /// From each draw; none where there are no draws.
    pub draws: Vec<f64>,
}

impl Varied {
    /// A number that is worked out from the means (`None`) and from each draw.
    pub(super) fn new(draws: usize, value: impl Fn(Option<usize>) -> f64) -> Self {
        Self { mean: value(None), draws: (0..draws).map(|draw| value(Some(draw))).collect() }
    }

    /// From the means or a draw.
    pub(super) fn at(&self, draw: Option<usize>) -> f64 {
        match draw {
            None => self.mean,
            Some(draw) => self.draws.get(draw).copied().unwrap_or(f64::NAN),
        }
    }

    /// Ends of the 90 % interval; `None` without draws.
    #[must_use]
    pub fn interval(&self) -> Option<[f64; 2]> {
        interval(&self.draws)
    }
}

/// Quantiles of 5 and 95 % of draws, on the line between the two nearest.
pub(super) fn interval(draws: &[f64]) -> Option<[f64; 2]> {
    if draws.len() < 2 || draws.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let mut sorted = draws.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some([0.05, 0.95].map(|p| quantile(&sorted, p)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_hold_the_middle_of_the_draws() {
        let draws: Vec<f64> = (0..101).rev().map(f64::from).collect();
        assert_eq!(interval(&draws), Some([5.0, 95.0]));
        assert_eq!(interval(&[1.0, f64::NAN, 2.0]), None);
        assert_eq!(interval(&[]), None);
        let sum = Varied::new(3, |draw| draw.map_or(0.0, |k| k as f64));
        assert_eq!((sum.at(None), sum.at(Some(2))), (0.0, 2.0));
        assert!(sum.at(Some(3)).is_nan());
    }
}
