//! What a test found, in words and numbers.

use crate::detectable::{Detectable, hardest};
use std::fmt;

/// One number with its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistic {
    /// What it is of, for instance the name of a test function.
    pub name: String,
    /// Its value: a z-score, a χ², a distance, an error.
    pub value: f64,
    /// Where it is judged: the least p-value that is allowed, or the largest error.
    pub bound: Bound,
}

/// How a statistic is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// A p-value under the hypothesis that all is well; it must exceed `above`.
    Probability {
        /// The p-value.
        p: f64,
        /// The threshold of the stage, divided by the number of statistics.
        above: f64,
    },
    /// The value itself must lie in a closed range. NaN never does.
    Range {
        /// Least allowed value.
        least: f64,
        /// Largest allowed value.
        most: f64,
    },
}

impl Statistic {
    /// Whether the bound holds. NaN holds nowhere.
    #[must_use]
    pub fn holds(&self) -> bool {
        match self.bound {
            Bound::Probability { p, above } => p > above,
            Bound::Range { least, most } => (least..=most).contains(&self.value),
        }
    }

    /// How near to its bound it is, for sorting: 1 is far, 0 at the bound, less is beyond.
    fn margin(&self) -> f64 {
        match self.bound {
            Bound::Probability { p, above } if p.is_finite() => 1.0 - p.ln() / above.ln(),
            Bound::Range { least, most } if self.value.is_finite() => {
                let (inside, width) = ((self.value - least).min(most - self.value), most - least);
                if width.is_finite() { 2.0 * inside / width } else { inside / self.value.abs().max(f64::MIN_POSITIVE) }
            }
            _ => f64::NEG_INFINITY,
        }
    }
}

impl fmt::Display for Statistic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {:.4}", self.name, Short(self.value))?;
        match self.bound {
            Bound::Probability { p, above } => write!(f, ", p = {p:.2e}, must exceed {above:.2e}"),
            Bound::Range { least, most: f64::INFINITY } => write!(f, ", at least {}", Short(least)),
            Bound::Range { least: f64::NEG_INFINITY, most } => write!(f, ", at most {}", Short(most)),
            Bound::Range { least, most } => write!(f, ", between {} and {}", Short(least), Short(most)),
        }
    }
}

/// A number that stays readable when it is tiny.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(6);
        if self.0 != 0.0 && self.0.is_finite() && !(1e-3..1e6).contains(&self.0.abs()) {
            write!(f, "{:.digits$e}", self.0)
        } else if f.precision().is_some() {
            write!(f, "{:.digits$}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// What one test found. [`Report::assert_holds`] panics with all of it unless every statistic keeps its bound.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Name of the test.
    pub test: &'static str,
    /// What was measured, with the sizes of the last stage.
    pub measured: String,
    /// What a failure shows, and what passes although it is wrong.
    pub would_show: &'static str,
    /// The statistics of the last stage.
    pub statistics: Vec<Statistic>,
    /// Sizes of errors that a test like this one sees in nine of ten runs: what it means that it passed. Empty for tests that cannot say.
    pub detectable: Vec<Detectable>,
    /// Probability that the whole test fails where all is well; 0 for tests without randomness.
    pub false_alarm_rate: f64,
    /// Stages that were run (see [`crate::Control`]).
    pub stages: usize,
    /// The seed, for those tests that draw.
    pub seed: Option<u64>,
}

impl Report {
    /// A report of a test without randomness.
    pub(crate) fn exact(test: &'static str, measured: String, would_show: &'static str, found: Vec<Statistic>) -> Self {
        Self {
            test,
            measured,
            would_show,
            statistics: found,
            detectable: vec![],
            false_alarm_rate: 0.0,
            stages: 1,
            seed: None,
        }
    }

    /// Whether all statistics keep their bounds. A report without statistics holds nothing.
    #[must_use]
    pub fn holds(&self) -> bool {
        !self.statistics.is_empty() && self.statistics.iter().all(Statistic::holds)
    }

    /// The statistic that is nearest to its bound, or furthest beyond it.
    #[must_use]
    pub fn worst(&self) -> Option<&Statistic> {
        self.statistics.iter().min_by(|a, b| a.margin().total_cmp(&b.margin()))
    }

    /// Panics with the report unless it holds.
    ///
    /// # Panics
    /// When a statistic is beyond its bound: this is what a test wants.
    #[track_caller]
    pub fn assert_holds(&self) {
        assert!(self.holds(), "{self}");
    }

    /// Panics with the report if it holds: for a sampler with a planted bug.
    ///
    /// # Panics
    /// When all statistics keep their bounds.
    #[track_caller]
    pub fn assert_fails(&self) {
        assert!(!self.holds(), "nothing was found where a failure was expected\n{self}");
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let failed = self.statistics.iter().filter(|s| !s.holds()).count();
        let verdict = if self.holds() { "holds" } else { "FAILS" };
        writeln!(
            f,
            "{} {verdict}: {failed} of {} statistics are beyond their bounds",
            self.test,
            self.statistics.len()
        )?;
        writeln!(f, "  measured: {}", self.measured)?;
        let mut sorted: Vec<&Statistic> = self.statistics.iter().collect();
        sorted.sort_by(|a, b| a.margin().total_cmp(&b.margin()));
        for statistic in sorted.iter().take(failed.clamp(3, 8)) {
            writeln!(f, "  {} {statistic}", if statistic.holds() { " " } else { "✗" })?;
        }
        if failed > 8 {
            writeln!(f, "    … and {} more", failed - 8)?;
        }
        if failed > 0 {
            writeln!(f, "  a failure shows: {}", self.would_show)?;
        } else if !self.detectable.is_empty() {
            let seen: Vec<String> = hardest(&self.detectable).map(|one| one.to_string()).collect();
            writeln!(f, "  sees 9 times in 10: {}", seen.join("; "))?;
        }
        match self.seed {
            Some(seed) if self.false_alarm_rate == 0.0 => write!(f, "  bounds of the caller; seed {seed}"),
            Some(seed) => {
                write!(f, "  false alarms: {:.0e} a test; stage {}; seed {seed}", self.false_alarm_rate, self.stages)
            }
            None => write!(f, "  no randomness: a failure is no accident"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(value: f64, bound: Bound) -> Report {
        let statistic = Statistic { name: "x".into(), value, bound };
        Report::exact("a test", "one number".into(), "a bug", vec![statistic])
    }

    #[test]
    fn nan_and_nothing_hold_nowhere() {
        assert!(!of(f64::NAN, Bound::Range { least: f64::NEG_INFINITY, most: f64::INFINITY }).holds());
        assert!(!of(0.0, Bound::Probability { p: f64::NAN, above: 1e-6 }).holds());
        assert!(!Report::exact("a test", String::new(), "", vec![]).holds());
        assert!(of(1.0, Bound::Range { least: 1.0, most: 1.0 }).holds());
    }

    #[test]
    fn a_failure_names_the_worst_first_and_what_it_shows() {
        let mut report = of(2.0, Bound::Range { least: f64::NEG_INFINITY, most: 1.0 });
        let fine = Statistic { name: "y".into(), value: 0.0, bound: Bound::Probability { p: 0.5, above: 1e-7 } };
        report.statistics.insert(0, fine);
        let text = report.to_string();
        assert!(text.contains("a test FAILS: 1 of 2"), "{text}");
        assert!(text.find("✗ x: 2.0000, at most 1").unwrap() < text.find("y: 0.0000, p = 5.00e-1").unwrap(), "{text}");
        assert!(text.contains("a failure shows: a bug") && text.contains("no randomness"), "{text}");
        assert_eq!(report.worst().map(|s| s.name.as_str()), Some("x"));
    }
}
