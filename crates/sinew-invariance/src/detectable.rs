//! The size of error that a test would have seen.
//!
//! A test that passes says something only together with what it would have failed. Let a statistic be a z-score whose mean is λ at the first stage's size, so λ √g at a stage with g times the draws. With p_s and q_s the
//! p-values at or below which stage s fails and at or below which it does not hold ([`crate::Control`]), the test fails with probability Σ_s Π_{r<s} P(p_r < p ≤ q_r) · P(p ≤ p_s): stages are independent. The λ at which that
//! is nine in ten, times the standard error of the statistic in the first stage, is the size that is reported. Other statistics are taken to be right; their doubts make a further stage, and so a failure, a little likelier.

use crate::TestFunctions;
use crate::control::{Control, Threshold};
use crate::p_values::{kolmogorov_p, normal_p};
use statrs::distribution::{ContinuousCDF, Normal};
use std::fmt;

/// An error of a size that makes a test fail in nine of ten runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectable {
    /// The test function that shows it.
    pub of: String,
    /// What is wrong.
    pub what: Wrong,
    /// By how much.
    pub size: f64,
}

/// What the size of an error is measured in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrong {
    /// The mean of the function, in its standard deviations under the target.
    Mean,
    /// The standard deviation of a coordinate, relative to the right one; shown by the coordinate's square.
    StandardDeviation,
    /// The distribution function of the test function, at the place where it is most wrong.
    Distribution,
}

impl fmt::Display for Detectable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.what {
            Wrong::Mean => write!(f, "a mean wrong by {:.2} standard deviations ({})", self.size, self.of),
            Wrong::StandardDeviation => {
                write!(f, "a standard deviation wrong by {:.1} % ({})", 100.0 * self.size, self.of)
            }
            Wrong::Distribution => write!(f, "a distribution function wrong by {:.3} ({})", self.size, self.of),
        }
    }
}

/// Of every kind, the error that is hardest to see.
pub(crate) fn hardest(all: &[Detectable]) -> impl Iterator<Item = &Detectable> {
    [Wrong::StandardDeviation, Wrong::Mean, Wrong::Distribution]
        .into_iter()
        .filter_map(|what| all.iter().filter(|one| one.what == what).max_by(|a, b| a.size.total_cmp(&b.size)))
}

/// An error as large as one standard error of its statistic.
pub(crate) type OneSigma = (Wrong, f64);

/// Mean and variance of a test function under the target, and the standard error of what the test says of the mean.
pub(crate) struct Estimate {
    pub mean: f64,
    pub variance: f64,
    pub error: f64,
}

/// In units that a reader understands; `None` where the function is constant or was not moved.
pub(crate) fn one_sigma(functions: &TestFunctions<'_>, of: &[Estimate]) -> Vec<Option<OneSigma>> {
    let one = |(estimate, coordinate): (&Estimate, Option<usize>)| {
        let found = match coordinate {
            // A relative change ε of the standard deviation changes the mean square by 2 ε times the variance.
            Some(at) => {
                let variance = estimate.mean - of[at].mean.powi(2);
                (Wrong::StandardDeviation, estimate.error / (2.0 * variance))
            }
            None => (Wrong::Mean, estimate.error / estimate.variance.sqrt()),
        };
        (found.1.is_finite() && found.1 > 0.0).then_some(found)
    };
    of.iter().zip(functions.coordinates_of_squares()).map(one).collect()
}

/// Share of runs that are to fail.
const POWER: f64 = 0.9;

/// The mean λ of a z-score in the first stage, one of `count` statistics, at which the test fails with probability [`POWER`].
pub(crate) fn z_score(control: &Control, count: usize) -> f64 {
    shift(control, count, 1.0, |p| least(|z| normal_p(z) <= p))
}

/// The same for √n D of two distribution functions at a distance D. Where they differ most, √n times the observed difference has that mean, and a standard deviation of at most ½.
pub(crate) fn root_n_distance(control: &Control, count: usize) -> f64 {
    shift(control, count, 0.5, |p| least(|x| kolmogorov_p(x) <= p))
}

/// The mean of a normal statistic with this standard deviation; `bound` turns a p-value into the least value of the statistic that has it.
fn shift(control: &Control, count: usize, sd: f64, bound: impl Fn(f64) -> f64) -> f64 {
    let normal = Normal::standard();
    let mut stages = vec![];
    let mut threshold = Threshold::first(control);
    loop {
        let [fails, doubtful] = [threshold.fails, threshold.doubtful].map(|p| bound(p / count as f64));
        stages.push((fails, doubtful, (threshold.growth as f64).sqrt()));
        if threshold.is_last() {
            break;
        }
        threshold = threshold.next();
    }
    least(|mean| {
        let (mut failed, mut reached) = (0.0, 1.0);
        for (fails, doubtful, root) in &stages {
            let beyond = |bound: f64| normal.sf((bound - mean * root) / sd);
            failed += reached * beyond(*fails);
            reached *= beyond(*doubtful) - beyond(*fails);
        }
        failed >= POWER
    })
}

/// The least number at which something that holds from there on holds, up to 128.
fn least(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut below, mut at) = (0.0, 128.0);
    for _ in 0..50 {
        let middle = 0.5 * (below + at);
        if holds(middle) { at = middle } else { below = middle }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_stage_is_the_textbook_formula() {
        let control = Control { false_alarm_rate: 0.05, stages: 1, growth: 4 };
        assert!((z_score(&control, 1) - (1.959_964 + 1.281_552)).abs() < 1e-5);
        assert!((root_n_distance(&control, 1) - (1.358_099 + 0.5 * 1.281_552)).abs() < 1e-4);
        assert!((z_score(&control, 5) - (2.575_829 + 1.281_552)).abs() < 1e-5);
    }

    #[test]
    fn more_stages_see_smaller_errors_and_stricter_rates_larger_ones() {
        let control = |rate, stages| Control { false_alarm_rate: rate, stages, growth: 4 };
        assert!(z_score(&control(1e-6, 3), 4) < z_score(&control(1e-6, 1), 4) - 1.0);
        assert!(z_score(&control(1e-9, 3), 4) > z_score(&control(1e-6, 3), 4));
    }

    #[test]
    fn the_hardest_error_of_every_kind_is_named() {
        let of = |name: &str, what, size| Detectable { of: name.into(), what, size };
        let all = [of("a", Wrong::Mean, 0.1), of("b", Wrong::Mean, 0.2), of("c", Wrong::StandardDeviation, 0.031)];
        let text: Vec<String> = hardest(&all).map(ToString::to_string).collect();
        assert_eq!(text, ["a standard deviation wrong by 3.1 % (c)", "a mean wrong by 0.20 standard deviations (b)"]);
    }
}
