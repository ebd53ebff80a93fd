//! `sinew predict`: what a camera that a run did not use should see, as a table.

use super::args::{General, PredictArgs};
use super::ended::Ended;
use super::error::{Error, Written};
use super::report::{self, Report};
use serde_json::json;
use sinew::predict::predict;
use sinew_results::Occupied;
use sinew_results::write_whole;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &PredictArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Prediction));
    };
    let path = Path::new(out);
    if path.exists() && !general.force {
        return Err(sinew_results::Error::OutputExists { path: path.to_owned(), found: Occupied::File }.into());
    }
    let prediction = predict(&args.results, &args.calibration, &args.camera)?;
    write_whole(path, prediction.to_csv().as_bytes())?;
    let rows = prediction.predicted.iter().flatten().count();
    report.detail(&format!("{} frames, {} keypoints", prediction.frames.len(), prediction.keypoints.len()));
    if args.answer.json {
        report::answer_json(&json!({ "out": out, "camera": prediction.camera.name, "observations": rows }))?;
    } else {
        report::answer(&format!("{rows} observations of {} predicted in {out}\n", prediction.camera.name))?;
    }
    Ok(Ended::Done)
}
