//! Statistics of joint angles over the trials of a group, with intervals.
//! Trials lie within half a turn of the mean of those before them, and the mean of all within half a turn of 0; a range is no direction and stays.
//!
//! For each draw the mean over the trials is taken, and the interval is that over the draws. In trials with one set-up draw i is of the same cameras, sizes and biases, in trials of several subjects of a session of the same cameras: an error that all trials share stays in the interval of their
//! mean. Draws of trials with set-ups of their own are paired as they come, and come from random numbers of their own, but for copies of a trial, which err alike: what such trials share without saying so, as cameras, then averages out too much.

use super::angle_draws::AngleOverTime;
use super::trial_table::quoted;
use sinew::angles::circle::{self, TURN_DEG};
use sinew::core::estimators::{mean, quantile};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// What is taken of an angle over the time of a trial.
const MEAN: &str = "mean over time";
const RANGE: &str = "range over time";

/// What is known of an angle in a group of trials.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GroupAngle {
    pub(super) group: String,
    pub(super) angle: String,
    /// [`MEAN`] or [`RANGE`].
    pub(super) what: &'static str,
    pub(super) trials: usize,
    /// Mean over the trials: of the draws, and the ends of its 90 % interval, degrees.
    pub(super) mean_deg: f64,
    pub(super) interval_deg: [f64; 2],
    /// Standard deviation between the trials' own means, degrees; NaN for one trial.
    pub(super) sd_between_deg: f64,
}

/// Trials of a group, one after the other: memory does not grow with their number.
#[derive(Clone, Debug, Default)]
struct RunningMean {
    trials: usize,
    /// Sum over the trials, by draw.
    sums: Vec<f64>,
    /// Mean of the trials' own means, and the sum of squares about it.
    middle: f64,
    squares: f64,
}

impl RunningMean {
    /// Whole turns that bring the draws of a trial next to the trials before it.
    fn turns_to(&self, draws: &[f64]) -> f64 {
        let own = mean(draws);
        if self.trials == 0 { 0.0 } else { circle::near(own, self.middle, TURN_DEG) - own }
    }

    fn add(&mut self, draws: &[f64]) {
        match self.trials {
            0 => self.sums = draws.to_vec(),
            _ => {
                self.sums.truncate(draws.len());
                self.sums.iter_mut().zip(draws).for_each(|(sum, draw)| *sum += draw);
            }
        }
        self.trials += 1;
        let own = mean(draws);
        let step = own - self.middle;
        self.middle += step / self.trials as f64;
        self.squares += step * (own - self.middle);
    }

    /// Mean over the trials with its 90 % interval, and the standard deviation between the trials.
    fn statistics(&self) -> (f64, [f64; 2], f64) {
        let mut means: Vec<f64> = self.sums.iter().map(|sum| sum / self.trials as f64).collect();
        means.sort_by(f64::total_cmp);
        let between = (self.squares / (self.trials as f64 - 1.0)).sqrt();
        (mean(&means), [0.05, 0.95].map(|p| quantile(&means, p)), between)
    }
}

/// An angle, and what is taken of it over time.
type AngleKey = (String, &'static str);

/// Angles of the trials of each group.
#[derive(Default)]
pub(super) struct Groups(BTreeMap<String, BTreeMap<AngleKey, RunningMean>>);

impl Groups {
    /// Adds a trial to a group.
    pub(super) fn add(&mut self, group: &str, angles: Vec<(String, AngleOverTime)>) {
        let own = self.0.entry(group.to_owned()).or_default();
        for (name, AngleOverTime { mean_deg, range_deg }) in angles {
            for (what, draws) in [(MEAN, mean_deg), (RANGE, range_deg)] {
                if !draws.is_empty() {
                    let known = own.entry((name.clone(), what)).or_default();
                    let turns = if what == MEAN { known.turns_to(&draws) } else { 0.0 };
                    known.add(&draws.iter().map(|draw| draw + turns).collect::<Vec<f64>>());
                }
            }
        }
    }

    /// The statistics, by group and angle.
    pub(super) fn statistics(&self) -> Vec<GroupAngle> {
        let statistics_in = |(group, angles): (&String, &BTreeMap<AngleKey, RunningMean>)| {
            let statistics_for = |((angle, what), known): (&AngleKey, &RunningMean)| {
                let (mean_deg, interval_deg, sd_between_deg) = known.statistics();
                let turns = if *what == MEAN { circle::near(mean_deg, 0.0, TURN_DEG) - mean_deg } else { 0.0 };
                let (mean_deg, interval_deg) = (mean_deg + turns, interval_deg.map(|end| end + turns));
                let (group, angle) = (group.clone(), angle.clone());
                GroupAngle { group, angle, what, trials: known.trials, mean_deg, interval_deg, sd_between_deg }
            };
            angles.iter().map(statistics_for).collect::<Vec<_>>()
        };
        self.0.iter().flat_map(statistics_in).collect()
    }
}

/// The statistics as a table.
pub(super) fn to_csv(statistics: &[GroupAngle]) -> String {
    let mut text = "group,angle,what,trials,mean_deg,q05_deg,q95_deg,sd_between_trials_deg\n".to_owned();
    for GroupAngle { group, angle, what, trials, mean_deg, interval_deg: [low, high], sd_between_deg } in statistics {
        let between = if sd_between_deg.is_finite() { format!("{sd_between_deg:.4}") } else { String::new() };
        let group = quoted(group);
        let _ = writeln!(text, "{group},{angle},{what},{trials},{mean_deg:.4},{low:.4},{high:.4},{between}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn over(trials: &[Vec<f64>]) -> (f64, [f64; 2], f64) {
        let mut known = RunningMean::default();
        trials.iter().for_each(|trial| known.add(trial));
        known.statistics()
    }

    /// An error that all trials share stays in the mean of four, errors of their own shrink by two.
    #[test]
    fn a_shared_error_stays_in_the_interval_of_the_mean() {
        const DRAWS: usize = 4001;
        // Equally spaced from −1 to 1: standard deviation 1/√3, of a mean of four nearly Gaussian.
        let shared: Vec<f64> = (0..DRAWS).map(|k| 2.0 * k as f64 / (DRAWS - 1) as f64 - 1.0).collect();
        let width = |trials: &[Vec<f64>]| {
            let (_, [low, high], _) = over(trials);
            (high - low) / 2.0
        };
        assert!((width(&vec![shared.clone(); 4]) - 0.9).abs() < 1e-3);
        // Orders of the draws that have nothing to do with each other.
        let own = |step: usize| (0..DRAWS).map(|k| shared[k * step % DRAWS]).collect::<Vec<f64>>();
        let apart = width(&[1, 1231, 2347, 577].map(own));
        assert!((apart - 1.645 * 0.5 / 3.0_f64.sqrt()).abs() < 0.02, "{apart}");
    }

    #[test]
    fn trials_differ_by_their_means() {
        let (mean, _, sd) = over(&[vec![1.0, 3.0], vec![5.0, 7.0]]);
        assert!((mean - 4.0).abs() < 1e-12 && (sd - 8.0_f64.sqrt()).abs() < 1e-12);
        assert!(over(&[vec![1.0, 2.0]]).2.is_nan());
    }
}
