//! What a result folder says of its run, and whether the run came to its end.

use super::facts::{Facts, Odd};
use super::people;
use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_results::problem;
use sinew_results::{LOCK_NAME, RESULT_NAMES, is_in_use};
use std::path::Path;

/// Whether a folder holds results, whole or not.
pub(super) fn is_results(folder: &Path) -> bool {
    ["summary.json", "markers.trc", LOCK_NAME].iter().any(|name| folder.join(name).exists()) || partials(folder) > 0
}

/// Number of files that are not whole.
fn partials(folder: &Path) -> usize {
    RESULT_NAMES.iter().filter(|name| folder.join(format!("{name}.partial")).exists()).count()
}

pub(super) fn facts(folder: &Path) -> Result<Facts, Error> {
    let summary = folder.join("summary.json");
    let mut facts = if summary.exists() {
        let summary: Value = json_text::parse(&summary.display().to_string(), &read_text(&summary, MAX_TEXT_BYTES)?)?;
        if summary["people"].is_array() {
            return people::facts(folder, &summary);
        }
        summary_facts(folder, &summary)
    } else {
        Facts::new(format!("{}: results", folder.display()))
    };
    let partials = partials(folder);
    if folder.join(problem::NAME).exists() && !is_in_use(folder) {
        facts.odd.push(Odd::Stopped);
    }
    let odd = match (is_in_use(folder), summary.exists()) {
        (true, true) => "a run is writing into it now; these facts are about an earlier one",
        (true, false) => "a run is writing into it now; no file is whole before its end",
        (false, true) if partials > 0 => "a later run was stopped before its end and left its files `*.partial`",
        (false, true) => return Ok(facts),
        (false, false) if partials > 0 => {
            "no summary.json: the run was stopped before its end and left its files `*.partial`"
        }
        (false, false) => "no summary.json: the run was stopped before its end",
    };
    facts.odd.push(odd.into());
    if partials > 0 {
        facts.row("partial files", partials.to_string());
    }
    let frames = folder.join("frames.csv.partial");
    if frames.exists() {
        let lines = read_text(&frames, MAX_TEXT_BYTES)?.matches('\n').count();
        facts.row("frames so far", lines.saturating_sub(1).to_string());
    }
    Ok(facts)
}

/// Says how many zeros a standing trial took off angles, and the largest.
fn zero_row(facts: &mut Facts, zeros: &Value) {
    let zeros: Vec<(&String, &Value)> = zeros.as_object().into_iter().flatten().collect();
    let numbers = |(name, zero): &(&String, &Value)| Some(((*name).clone(), zero[0].as_f64()?, zero[1].as_f64()?));
    let largest = zeros.iter().filter_map(numbers).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
    if let Some((name, mean, sd)) = largest {
        let count = zeros.len();
        let words =
            format!("a standing trial, taken off {count} angles; the largest is `{name}`: {mean:.1}° ± {sd:.1}°");
        facts.row("zero of angles", words);
    }
}

fn summary_facts(folder: &Path, summary: &Value) -> Facts {
    let text_of = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let version = text_of(&summary["sinew_version"]);
    let mut facts = Facts::new(format!(
        "{}: results of sinew {version}, {} {}",
        folder.display(),
        text_of(&summary["kind"]),
        text_of(&summary["method"])
    ));
    let frames = format!(
        "{} ({}..{}), {} observed, {} per second",
        summary["frame_count"], summary["frames"][0], summary["frames"][1], summary["observed_frames"], summary["fps"]
    );
    facts.row("frames", frames);
    facts.row("seed", format!("{}, instruction set {}", summary["seed"], text_of(&summary["isa"])));
    let number = |value: &Value, digits: usize| value.as_f64().map_or("-".into(), |x| format!("{x:.digits$}"));
    let diagnostics = &summary["diagnostics"];
    let r_hat = &diagnostics["r_hat"];
    if r_hat.is_object() {
        facts.row("R-hat", format!("median {}, 95 % {}", number(&r_hat["median"], 3), number(&r_hat["p95"], 3)));
    }
    facts.row("effective size", format!("median {}", number(&diagnostics["ess_median"], 0)));
    for camera in summary["cameras"].as_array().into_iter().flatten() {
        facts.row(
            text_of(&camera["name"]),
            format!("residual {} px, {} frames", number(&camera["residual_px"], 1), camera["frames"]),
        );
    }
    zero_row(&mut facts, &summary["angles"]["zero_deg"]);
    let uncertainty = &summary["uncertainty"];
    if uncertainty.is_object() {
        facts.row("uncertainty", text_of(&uncertainty["words"]));
        for words in uncertainty["help"].as_array().into_iter().flatten().map(text_of) {
            let (source, rest) = words.split_once(": ").unwrap_or(("would help", &words));
            facts.row(source, rest);
        }
    }
    if summary["complete"] != true {
        facts.odd.push("the run was interrupted: not all frames are there".into());
    }
    let list = |name: &str| summary[name].as_array().into_iter().flatten().map(text_of).collect::<Vec<_>>();
    facts
        .odd
        .extend(list("failed_diagnostics").iter().map(|failed| Odd::Words(format!("diagnostic failed: {failed}"))));
    facts.odd.extend(list("warnings").into_iter().map(Odd::Words));
    facts
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_largest_zero_may_be_a_negative_one() {
        let mut facts = Facts::new(String::new());
        zero_row(&mut facts, &json!({ "knee_angle_r": [3.0, 1.0], "ankle_angle_r": [-7.0, 2.0] }));
        let [(name, words)] = &facts.rows[..] else { panic!("{facts:?}") };
        assert_eq!(name, "zero of angles");
        assert!(words.ends_with("taken off 2 angles; the largest is `ankle_angle_r`: -7.0° ± 2.0°"), "{words}");
    }
}
