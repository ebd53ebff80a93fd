//! `sinew gait`: events, strides and angles over the cycle of a person who walks, from a result folder.

use super::args::General;
use super::ended::Ended;
use super::error::Error;
use super::gait_args::GaitArgs;
use super::report::{self, Report};
use super::table::aligned;
use serde_json::{Map, Value, json};
use sinew_analysis::gait::{GaitAnalysis, PARAMETERS, ParameterSummary, gait, gait_files, summary};
use sinew_results::{GAIT_NAMES, Occupied, list_derived, write_whole};
use std::path::{Path, PathBuf};

/// What the times of events are, and what tells contact.
const EVENTS: &str = "strikes are where a heel is farthest ahead of the pelvis, toe offs where a toe is farthest behind: \
     not contact with the ground, which force plates tell";

/// Sides in the order of the answer.
const SIDES: [(&str, Option<usize>); 3] = [("left", Some(0)), ("right", Some(1)), ("both", None)];

/// Runs the command.
pub(crate) fn run(args: &GaitArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let out = general.out.as_ref().map_or_else(|| args.results.clone(), PathBuf::from);
    if out.is_file() {
        return Err(sinew_results::Error::OutputExists { path: out, found: Occupied::NotAFolder }.into());
    }
    if let Some(path) = GAIT_NAMES.map(|name| out.join(name)).into_iter().find(|path| path.exists())
        && !general.force
    {
        return Err(sinew_results::Error::OutputExists { path, found: Occupied::File }.into());
    }
    let found = gait(&args.results)?;
    let files = gait_files(&found, &name(&args.results))?;
    std::fs::create_dir_all(&out).map_err(sinew::Error::io("create", &out))?;
    for (name, text) in files {
        write_whole(&out.join(name), text.as_bytes())?;
    }
    list_derived(&out, &GAIT_NAMES)?;
    report.warnings(&found.warnings);
    if args.answer.json {
        report::answer_json(&as_json(&found, &out))?;
    } else {
        report::answer(&as_table(&found, &out))?;
    }
    Ok(Ended::Done)
}

/// Name of a folder, also of `.`.
fn name(folder: &Path) -> String {
    let whole = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    whole.file_name().map_or_else(|| "gait".to_owned(), |name| format!("gait: {}", name.to_string_lossy()))
}

fn strides(found: &GaitAnalysis, side: Option<usize>) -> usize {
    found.strides.iter().filter(|stride| side.is_none_or(|side| stride.side == side)).count()
}

fn as_json(found: &GaitAnalysis, out: &Path) -> Value {
    let summarised = |summary: &ParameterSummary| json!({ "strides": summary.strides, "mean": summary.mean.mean, "interval": summary.mean.interval(), "sd": summary.sd });
    let side = |(name, side): (&str, Option<usize>)| {
        let all = PARAMETERS.iter().zip(summary(&found.strides, side));
        let parameters: Map<String, Value> =
            all.filter_map(|(name, found)| Some(((*name).to_owned(), summarised(&found?)))).collect();
        (name.to_owned(), Value::from(parameters))
    };
    let sides: Map<String, Value> = SIDES.into_iter().map(side).collect();
    json!({
        "events": found.events.len(),
        "strides": found.strides.len(),
        "parameters": sides,
        "definition": EVENTS,
        "warnings": found.warnings,
        "out": out.to_string_lossy(),
    })
}

/// What of the parameters a reader looks at first: name, its words, factor and unit.
const SHOWN: [(&str, &str, f64, &str); 6] = [
    ("speed_m_per_s", "speed", 1.0, "m/s"),
    ("cadence_per_min", "cadence", 1.0, "steps a minute"),
    ("step_length_m", "step length", 1000.0, "mm"),
    ("step_width_m", "step width", 1000.0, "mm"),
    ("stance_share", "stance", 100.0, "%"),
    ("double_support_share", "double support", 100.0, "%"),
];

fn as_table(found: &GaitAnalysis, out: &Path) -> String {
    let [left, right, _] = SIDES.map(|(_, side)| strides(found, side));
    let mut rows = vec![("strides".to_owned(), format!("{left} left, {right} right, {} events", found.events.len()))];
    for (parameter, words, factor, unit) in SHOWN {
        let place = PARAMETERS.iter().position(|name| *name == parameter).unwrap_or_default();
        let shown = SIDES.iter().filter_map(|(name, side)| {
            let found = summary(&found.strides, *side)[place].take()?;
            let number =
                |x: f64| format!("{:.*}", if factor * found.mean.mean.abs() < 10.0 { 2 } else { 0 }, factor * x);
            let ends = found.mean.interval().map(|[low, high]| format!(" ({} to {})", number(low), number(high)));
            Some(format!("{name} {}{}", number(found.mean.mean), ends.unwrap_or_default()))
        });
        let shown: Vec<String> = shown.collect();
        if !shown.is_empty() {
            rows.push((words.to_owned(), format!("{} {unit}", shown.join(", "))));
        }
    }
    rows.push(("files".to_owned(), GAIT_NAMES.map(|name| out.join(name).display().to_string()).join(", ")));
    rows.push(("events".to_owned(), EVENTS.to_owned()));
    aligned(&rows)
}
