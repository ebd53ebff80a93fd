//! `sinew inspect`: what files contain, and whether calibration and keypoints fit.

use super::Ended;
use super::args::{General, InspectArgs};
use super::report::{self, Report};
use super::track::aligned;
use serde_json::json;
use sinew::Error;
use sinew::inspect::{Facts, Subject, file_facts, fit, open, subject};

/// Runs the command.
pub(crate) fn run(args: &InspectArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let subjects = args.files.iter().map(|path| subject(path)).collect::<Result<Vec<Subject>, Error>>()?;
    let mut all: Vec<Facts> = Vec::new();
    for subject in &subjects {
        all.push(file_facts(subject, args.layout.as_deref())?);
    }
    let calibration =
        subjects.iter().find_map(|subject| if let Subject::Calibration(path) = subject { Some(path) } else { None });
    let keypoints =
        subjects.iter().find_map(|subject| if let Subject::Keypoints(path) = subject { Some(path) } else { None });
    if let (Some(calibration), Some(keypoints)) = (calibration, keypoints) {
        let mut recording = open(calibration, keypoints, args.layout.as_deref(), args.trim)?;
        // What was said about a file is not said again about the pair.
        let known: Vec<String> = all.iter().flat_map(|facts| facts.odd.clone()).collect();
        all.push(fit::facts(&mut recording, &known)?);
    }
    if general.json {
        let facts = |facts: &Facts| {
            let rows: serde_json::Map<_, _> =
                facts.rows.iter().map(|(name, value)| (name.clone(), value.clone().into())).collect();
            json!({ "title": facts.title, "facts": rows, "odd": facts.odd })
        };
        report::answer_json(&all.iter().map(facts).collect::<Vec<_>>().into())?;
    } else {
        let text: Vec<String> = all.iter().map(shown).collect();
        report::answer(&text.join("\n"))?;
    }
    report.detail(&format!("{} things looked at", all.len()));
    Ok(Ended::Done)
}

fn shown(facts: &Facts) -> String {
    let rows: Vec<(String, String)> =
        facts.rows.iter().map(|(name, value)| (format!("  {name}"), value.clone())).collect();
    let odd: String = facts.odd.iter().map(|odd| format!("  odd: {odd}\n")).collect();
    format!("{}\n{}{odd}", facts.title, aligned(&rows))
}
