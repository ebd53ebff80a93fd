//! `sinew export opensim`: a result as input of OpenSim's scaling and inverse kinematics.

use super::args::General;
use super::ended::Ended;
use super::error::Error;
use super::export_args::OpensimArgs;
use super::report::{self, Report};
use super::table::aligned;
use serde_json::{Map, Value, json};
use sinew_analysis::opensim::{OPENSIM_NAMES, OpensimFiles, opensim_files};
use sinew_results::Occupied;
use sinew_results::write_whole;
use std::path::{Path, PathBuf};

/// Folder in the results where none is named.
const FOLDER: &str = "opensim";

/// Runs the command.
pub(crate) fn run(args: &OpensimArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let out = general.out.as_ref().map_or_else(|| args.results.join(FOLDER), PathBuf::from);
    if out.is_file() {
        return Err(sinew_results::Error::OutputExists { path: out, found: Occupied::NotAFolder }.into());
    }
    if let Some(path) = OPENSIM_NAMES.map(|name| out.join(name)).into_iter().find(|path| path.exists())
        && !general.force
    {
        return Err(sinew_results::Error::OutputExists { path, found: Occupied::File }.into());
    }
    let found = opensim_files(&args.results, args.model.as_deref())?;
    std::fs::create_dir_all(&out).map_err(sinew::Error::io("create", &out))?;
    for (name, text) in &found.files {
        write_whole(&out.join(name), text.as_bytes())?;
    }
    if args.model.is_none() {
        report.note("no model was given: put one into the folder under the name model.osim, and in ik.xml let the lumbar coordinate that it has apply");
    }
    if args.answer.json {
        report::answer_json(&as_json(&found, &out))?;
    } else {
        report::answer(&as_table(&found, &out))?;
    }
    Ok(Ended::Done)
}

fn as_json(found: &OpensimFiles, out: &Path) -> Value {
    let weights: Map<String, Value> =
        found.weights.iter().map(|(name, weight)| (name.clone(), json!(weight))).collect();
    json!({
        "frames": found.frames,
        "weights": weights,
        "left_out": found.left_out,
        "out": out.to_string_lossy(),
    })
}

fn as_table(found: &OpensimFiles, out: &Path) -> String {
    let weights: Vec<String> = found.weights.iter().map(|(name, weight)| format!("{name} {weight:.2}")).collect();
    let mut rows = vec![("frames".to_owned(), found.frames.to_string()), ("weights".to_owned(), weights.join(", "))];
    if !found.left_out.is_empty() {
        rows.push(("not in the model".into(), found.left_out.join(", ")));
    }
    rows.push(("files".into(), OPENSIM_NAMES.map(|name| out.join(name).display().to_string()).join(", ")));
    rows.push(("next".into(), format!("opensim-cmd run-tool {}", out.join("scale.xml").display())));
    aligned(&rows)
}
