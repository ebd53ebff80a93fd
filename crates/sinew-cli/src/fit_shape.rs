//! `sinew fit-shape`: a body file with the thickness that masks show.

use super::args::{FitShapeArgs, General};
use super::ended::Ended;
use super::error::{Error, Written};
use super::progress::Progress;
use super::report::{self, Report};
use super::table::aligned;
use serde_json::json;
use sinew_analysis::shape_fit::{PartScale, ShapeFitRequest, fit_shape};
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &FitShapeArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Body));
    };
    let request = ShapeFitRequest {
        calibration: args.calibration.clone(),
        silhouettes: args.silhouettes.clone(),
        scale: args.mask_scale,
        frames: args.frames.clone(),
    };
    let mut progress: Option<Progress> = None;
    let (fitted, warnings) = fit_shape(&args.results, &request, Path::new(out), general.force, |done, total| {
        progress.get_or_insert_with(|| Progress::start(general, "fit", total)).at(done);
    })?;
    drop(progress);
    report.warnings(&warnings);
    if args.answer.json {
        let part = |part: &PartScale| json!({ "name": part.name, "base": part.scale[0], "top": part.scale[1] });
        report::answer_json(&json!({
            "out": out,
            "masks": fitted.masks,
            "mismatch_before": fitted.before,
            "mismatch_after": fitted.after,
            "scales": fitted.parts.iter().map(part).collect::<Vec<_>>(),
        }))?;
        return Ok(Ended::Done);
    }
    let part = |PartScale { name, scale: [base, top] }: &PartScale| {
        (name.clone(), format!("x {base:.2} at its base, x {top:.2} at its top"))
    };
    let mut rows: Vec<(String, String)> = fitted.parts.iter().map(part).collect();
    let share = |share: f64| format!("{:.1} %", 100.0 * share);
    rows.push((
        "wrong pixels".into(),
        format!("{} of the pixels of {} masks, before {}", share(fitted.after), fitted.masks, share(fitted.before)),
    ));
    rows.push(("written".into(), out.to_owned()));
    report::answer(&aligned(&rows))?;
    Ok(Ended::Done)
}
