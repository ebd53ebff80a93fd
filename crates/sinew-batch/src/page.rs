//! The page of a study: what is done, what failed and why, statistics by group.

use super::group_statistics::GroupAngle;
use super::plan::StudyPlan;
use super::trial_table::{Gathered, Row, TrialState, number_heads};
use sinew_report::page::html::{escaped, table};

const TEMPLATE: &str = include_str!("page.html");

/// Rows of trials that are shown; `summary.csv` has all.
const MOST_ROWS: usize = 2000;

/// The page.
pub(super) fn page(plan: &StudyPlan, gathered: &Gathered, rows: &[Row], statistics: &[GroupAngle]) -> String {
    let [done, doubtful, failed, missing] = gathered.counts;
    let counts = [
        ("done", done, "results are there"),
        ("doubtful", doubtful, "results are there, and a diagnostic failed"),
        ("failed", failed, "no results; the table says why"),
        ("missing", missing, "not run yet, or not since inputs or settings changed"),
    ];
    let counts: Vec<Vec<String>> =
        counts.iter().map(|(state, count, what)| vec![(*state).into(), count.to_string(), (*what).into()]).collect();
    // What needs a look comes first.
    let order = [TrialState::Failed, TrialState::Missing, TrialState::Doubtful, TrialState::Done];
    let sorted = order.iter().flat_map(|state| rows.iter().filter(move |row| row.state == *state));
    let shown: Vec<Vec<String>> = sorted.take(MOST_ROWS).map(|row| trial_row(plan, row)).collect();
    let mut heads = vec!["trial", "subject", "person", "state"];
    heads.extend(number_heads());
    heads.push("why");
    let more = match rows.len().saturating_sub(MOST_ROWS) {
        0 => String::new(),
        more => format!("<p>{more} more trials stand in <code>summary.csv</code>.</p>\n"),
    };
    let groups: Vec<Vec<String>> = statistics.iter().map(group_row).collect();
    let group_heads = ["group", "angle", "over time", "trials", "mean, °", "90 % interval, °", "SD between trials, °"];
    let parts = [
        ("root", escaped(&plan.root.display().to_string())),
        ("version", escaped(&plan.sinew_version)),
        ("counts", table("", &["state", "trials", "meaning"], &counts)),
        ("trials", table("", &heads, &shown) + &more),
        (
            "groups",
            if groups.is_empty() { "<p>No trial has angles yet.</p>".into() } else { table("", &group_heads, &groups) },
        ),
    ];
    sinew_report::page::html::filled(TEMPLATE, &parts)
}

fn trial_row(plan: &StudyPlan, row: &Row) -> Vec<String> {
    let Row { trial, subject, person, state, why, numbers } = row;
    let is_linked = !plan.packed && matches!(state, TrialState::Done | TrialState::Doubtful);
    let folder = if person.is_empty() { trial.clone() } else { format!("{trial}/people/{person}") };
    let name = match is_linked {
        true => format!("<a href=\"results/{}/\">{}</a>", escaped(&folder), escaped(trial)),
        false => escaped(trial),
    };
    let mut cells = vec![name, escaped(subject), escaped(person), state.word().to_owned()];
    cells.extend(numbers.iter().map(|cell| shortened(cell)));
    cells.push(escaped(why));
    cells
}

/// A number with as many digits as a table needs.
fn shortened(cell: &str) -> String {
    match cell.parse::<f64>() {
        Ok(number) if number.fract() != 0.0 => format!("{number:.3}"),
        _ => escaped(cell),
    }
}

fn group_row(known: &GroupAngle) -> Vec<String> {
    let [low, high] = known.interval_deg;
    let between = known.sd_between_deg;
    vec![
        escaped(&known.group),
        escaped(&known.angle),
        known.what.trim_end_matches(" over time").to_owned(),
        known.trials.to_string(),
        format!("{:.1}", known.mean_deg),
        format!("{low:.1} to {high:.1}"),
        if between.is_finite() { format!("{between:.1}") } else { "–".into() },
    ]
}
