//! The table of a study: a row a trial, or a row a person where a trial has several.

use super::plan::Task;
use serde_json::Value;
pub(super) use sinew_formats::tidy_csv::quoted;
use std::fmt::Write as _;

/// State of a trial in a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialState {
    /// Results were written, and all diagnostics passed.
    Done,
    /// Results were written, and at least one diagnostic failed.
    Doubtful,
    /// The trial was run and wrote no results; the reason is known.
    Failed,
    /// It was not run yet, or not since inputs or settings changed.
    Missing,
}

impl TrialState {
    /// In a word.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Doubtful => "doubtful",
            Self::Failed => "failed",
            Self::Missing => "missing",
        }
    }
}

/// What a study came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gathered {
    /// Trials by state: done, doubtful, failed, missing.
    pub counts: [usize; 4],
    /// Trials that failed or are missing, with why, in order.
    pub lacking: Vec<(String, String)>,
}

/// A row of the table: a trial, or one of several people in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) trial: String,
    pub(super) subject: String,
    pub(super) person: String,
    pub(super) state: TrialState,
    pub(super) why: String,
    /// Cells of [`NUMBERS`], empty where unknown.
    pub(super) numbers: Vec<String>,
}

/// Columns of the table that come from a summary, with where they stand there.
const NUMBERS: [(&str, &[&str]); 8] = [
    ("frames", &["frame_count"]),
    ("observed_frames", &["observed_frames"]),
    ("fps", &["fps"]),
    ("r_hat_median", &["diagnostics", "r_hat", "median"]),
    ("r_hat_frames_above_1_05", &["diagnostics", "r_hat", "frames_above_1_05"]),
    ("ess_median", &["diagnostics", "ess_median"]),
    ("divergences", &["diagnostics", "divergences"]),
    ("warnings", &["warnings"]),
];

/// The row of a task whose results have a summary.
pub(super) fn row(task: &Task, person: &str, state: TrialState, why: &str, summary: &Value) -> Row {
    let cell = |(_, keys): &(&str, &[&str])| match keys.iter().fold(summary, |value, key| &value[key]) {
        Value::Null => String::new(),
        Value::Array(items) => items.len().to_string(),
        value => value.to_string(),
    };
    Row {
        trial: task.trial.clone(),
        subject: task.subject.clone().unwrap_or_default(),
        person: person.to_owned(),
        state,
        why: why.to_owned(),
        numbers: NUMBERS.iter().map(cell).collect(),
    }
}

/// Heads of the columns with numbers.
pub(super) fn number_heads() -> [&'static str; NUMBERS.len()] {
    NUMBERS.map(|(head, _)| head)
}

/// The rows as CSV.
pub(super) fn table(rows: &[Row]) -> String {
    let mut text = format!("trial,subject,person,state,{},why\n", number_heads().join(","));
    for Row { trial, subject, person, state, why, numbers } in rows {
        let cells = [trial, subject, person].map(|cell| quoted(cell)).join(",");
        let _ = writeln!(text, "{cells},{},{},{}", state.word(), numbers.join(","), quoted(why));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn task(trial: &str) -> Task {
        let (session, hash) = (String::new(), String::new());
        Task { trial: trial.into(), has_file: true, hash, subject: None, session, pool: None, problem: None }
    }

    #[test]
    fn cells_with_commas_stay_one_cell() {
        let why = "`a`, then \"b\"";
        let row = row(&task("S1/walk"), "", TrialState::Failed, why, &Value::Null);
        let text = table(&[row]);
        assert!(text.ends_with(",failed,,,,,,,,,\"`a`, then \"\"b\"\"\"\n"), "{text}");
    }
}
