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

/// Findings by the two-stage rule: one that fails must fail again with another seed, by the same name, before it counts. Its rate of false alarms is then the square.
#[must_use]
pub fn in_two_stages(seed: u64, run: impl Fn(u64) -> Vec<Finding>) -> Vec<Outcome> {
    let first = run(seed);
    let again = if first.iter().all(Finding::holds) { vec![] } else { run(seed ^ 0x5eed_0000_0000_0000) };
    let of = |finding: &Finding| {
        let second = again.iter().find(|other| !finding.holds() && other.name == finding.name);
        let judged = second.unwrap_or(finding);
        let [least, most] = judged.bounds;
        Outcome {
            name: judged.name.clone(),
            holds: judged.holds(),
            worst: format!("{}: {:.4}, between {least} and {most}; {}", judged.name, judged.statistic, judged.detail),
            false_alarm_rate: finding.false_alarm.powi(2),
            statistics: 1,
            stages: 1 + usize::from(second.is_some()),
        }
    };
    first.iter().map(of).collect()
}
