//! What the result folder of a run of several people says of each of them.
//!
//! Who was seen stands in the `summary.json` of the whole run; what became of a person's run in that of their own folder, which is there before the whole run ends.

use super::facts::{Facts, Odd};
use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_results::{is_in_use, problem};
use std::path::Path;

/// The facts of a folder whose `summary.json` lists people.
pub(super) fn facts(folder: &Path, summary: &Value) -> Result<Facts, Error> {
    let people = summary["people"].as_array().map_or(&[][..], Vec::as_slice);
    let version = summary["sinew_version"].as_str().unwrap_or("of unknown version");
    let mut facts = Facts::new(format!("{}: results of sinew {version}, {} people", folder.display(), people.len()));
    let mut doubts = vec![];
    for person in people {
        let number = &person["person"];
        let own = folder.join(person["folder"].as_str().unwrap_or_default());
        let result = own_summary(&own)?;
        let became = became(person, result.as_ref(), &own);
        facts.row(format!("person {number}"), format!("{}; {became}", seen(person, summary)));
        let failed = result.iter().flat_map(|result| texts(result, "failed_diagnostics"));
        doubts.extend(failed.map(|failed| format!("person {number}: diagnostic failed: {failed}")));
        doubts.extend(person["failed"].as_str().map(|why| format!("person {number} is not tracked: {why}")));
        let warnings = result.as_ref().map_or(0, |result| texts(result, "warnings").count());
        if warnings > 0 {
            let word = if warnings == 1 { "warning" } else { "warnings" };
            doubts.push(format!("person {number}: {warnings} {word}; more: `sinew inspect {}`", own.display()));
        } else if result.is_some() {
            facts.row("  more", format!("`sinew inspect {}`", own.display()));
        }
    }
    if is_in_use(folder) {
        facts.odd.push("a run is writing into it now".into());
    } else if summary["complete"] != true {
        facts.odd.push(Odd::Unfinished);
    }
    facts.odd.extend(doubts.into_iter().map(Odd::Words));
    Ok(facts)
}

/// The summary of a person's run, if it came to an end.
fn own_summary(folder: &Path) -> Result<Option<Value>, Error> {
    let path = folder.join("summary.json");
    if !path.exists() {
        return Ok(None);
    }
    Ok(Some(json_text::parse(&path.display().to_string(), &read_text(&path, MAX_TEXT_BYTES)?)?))
}

/// When and by whom a person was seen, in words.
fn seen(person: &Value, summary: &Value) -> String {
    let [first, end] = [0, 1].map(|k: usize| person["frames"][k].as_u64().unwrap_or_default());
    let seen = person["seen_frames"].as_u64().unwrap_or_default();
    let seconds = |frames: u64| {
        let fps = summary["fps"].as_f64().filter(|fps| *fps > 0.0);
        fps.map(|fps| format!(" ({:.1} s)", frames as f64 / fps)).unwrap_or_default()
    };
    let names = summary["cameras"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let counts = person["camera_frames"].as_array().into_iter().flatten().filter_map(Value::as_u64);
    let by_camera: Vec<String> =
        names.zip(counts).filter(|(_, count)| *count > 0).map(|(name, count)| format!("{name} {count}")).collect();
    format!(
        "frames {first}..{end}{}, by two cameras in {seen}{}; {}",
        seconds(end.saturating_sub(first)),
        seconds(seen),
        by_camera.join(", ")
    )
}

/// What became of a person's run.
fn became(person: &Value, result: Option<&Value>, folder: &Path) -> &'static str {
    match result {
        Some(result) if result["complete"] == true => {
            if texts(result, "failed_diagnostics").next().is_some() {
                "tracked, doubtful"
            } else {
                "tracked"
            }
        }
        Some(_) => "tracked in part",
        None if person["failed"].is_string() => "not tracked",
        None if folder.join(problem::NAME).exists() => "tracked in part",
        None => "not tracked yet",
    }
}

fn texts<'a>(summary: &'a Value, key: &str) -> impl Iterator<Item = &'a str> + use<'a> {
    summary[key].as_array().into_iter().flatten().filter_map(Value::as_str)
}
