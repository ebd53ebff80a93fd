//! What a check leaves: a line that a person reads and a program sorts.

use crate::finding::Finding;
use sinew_invariance::{Bound, Report};

/// One finding of a check.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// What was looked at.
    pub name: String,
    /// Whether it is as claimed.
    pub holds: bool,
    /// The statistic nearest to its bound, with the bound.
    pub worst: String,
    /// Probability of a failure although all is well; 0 where nothing is random or the bound leaves chance no part.
    pub false_alarm_rate: f64,
    /// Number of statistics.
    pub statistics: usize,
    /// Stages that were run until the evidence was clear.
    pub stages: usize,
}

impl From<Report> for Outcome {
    fn from(report: Report) -> Self {
        let random = report.statistics.iter().any(|s| matches!(s.bound, Bound::Probability { .. }));
        Self {
            name: format!("{}: {}", report.test, report.measured),
            holds: report.holds(),
            worst: report.worst().map_or_else(String::new, ToString::to_string),
            false_alarm_rate: if random { report.false_alarm_rate } else { 0.0 },
            statistics: report.statistics.len(),
            stages: report.stages,
        }
    }
}

/// Findings by the two-stage rule: one that fails must fail again with another seed before it counts. Its rate of false alarms is then the square.
///
/// # Panics
/// When a check does not return the same findings in the same order for every seed.
#[must_use]
pub fn in_two_stages(seed: u64, run: impl Fn(u64) -> Vec<Finding>) -> Vec<Outcome> {
    let first = run(seed);
    let again = if first.iter().all(Finding::holds) { vec![] } else { run(seed ^ 0x5eed_0000_0000_0000) };
    let of = |(place, finding): (usize, &Finding)| {
        let second = again.get(place).filter(|_| !finding.holds());
        let judged = second.unwrap_or(finding);
        assert_eq!(judged.name, finding.name, "findings of two seeds, one by one");
        outcome(judged, finding.false_alarm.powi(2), 1 + usize::from(second.is_some()))
    };
    first.iter().enumerate().map(of).collect()
}

/// A finding as it is.
#[must_use]
pub fn outcome(finding: &Finding, false_alarm_rate: f64, stages: usize) -> Outcome {
    let [least, most] = finding.bounds;
    Outcome {
        name: finding.name.clone(),
        holds: finding.holds(),
        worst: format!("{}: {:.4}, between {least} and {most}; {}", finding.name, finding.statistic, finding.detail),
        false_alarm_rate,
        statistics: 1,
        stages,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails with the first seed, and with the second where `both`.
    fn unlucky(both: bool) -> Vec<Outcome> {
        in_two_stages(1, |seed| vec![Finding::score("a score", if both || seed == 1 { 9.0 } else { 0.5 }, 4.5, "")])
    }

    #[test]
    fn what_fails_once_is_asked_again() {
        let [once] = &unlucky(false)[..] else { panic!("one outcome") };
        assert!(once.holds && once.stages == 2);
        let [twice] = &unlucky(true)[..] else { panic!("one outcome") };
        assert!(!twice.holds && twice.stages == 2);
    }
}
