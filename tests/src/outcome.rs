//! What a check leaves: a line that a person reads and a program sorts.

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
