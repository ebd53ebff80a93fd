//! `sinew overlay`: pictures of the tracked body over what the cameras saw.

use super::args::{General, OverlayArgs};
use super::ended::Ended;
use super::error::{Error, Written};
use super::progress::Progress;
use super::report::{self, Report};
use serde_json::json;
use sinew_report::overlay::{Ground, OverlayRequest, overlay};
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &OverlayArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Pictures));
    };
    let request = OverlayRequest {
        calibration: args.calibration.clone(),
        ground: match (&args.images, &args.silhouettes) {
            (Some(images), _) => Ground::Images(images.clone()),
            (None, Some(masks)) => Ground::Silhouettes(masks.clone()),
            (None, None) => Ground::Black,
        },
        scale: args.mask_scale,
        frames: args.frames.clone(),
        every: args.every as usize,
    };
    let mut progress: Option<Progress> = None;
    let drawn = overlay(&args.results, &request, Path::new(out), general.force, |done, total| {
        progress.get_or_insert_with(|| Progress::start(general, "overlay", total)).at(done);
    })?;
    drop(progress);
    report.warnings(&drawn.warnings);
    if args.answer.json {
        report::answer_json(&json!({ "out": out, "pictures": drawn.pictures, "lacking": drawn.lacking }))?;
    } else {
        let lacking = match drawn.lacking {
            0 => String::new(),
            lacking => format!("; {lacking} views have no image and were left out"),
        };
        report::answer(&format!("{} pictures in {out}{lacking}\n", drawn.pictures))?;
    }
    Ok(Ended::Done)
}
