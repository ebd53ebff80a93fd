//! `sinew segment`: masks from images and images of the background.

use super::args::{General, SegmentArgs};
use super::ended::Ended;
use super::error::{Error, Written};
use super::progress::Progress;
use super::report::{self, Report};
use serde_json::json;
use sinew::observe::silhouettes::background::Config;
use sinew_analysis::segment::{SegmentRequest, segment};
use std::path::Path;

/// Runs the command.
pub(crate) fn run(args: &SegmentArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let Some(out) = general.out.as_deref() else {
        return Err(Error::NoPlace(Written::Masks));
    };
    let request = SegmentRequest {
        background: args.background.clone(),
        images: args.images.clone(),
        config: Config { threshold: args.threshold, shadow: args.shadow, ..Config::default() },
        least_part: args.least_part,
    };
    let mut progress: Option<Progress> = None;
    let made = segment(&request, Path::new(out), general.force, |done, total| {
        progress.get_or_insert_with(|| Progress::start(general, "segment", total)).at(done);
    })?;
    drop(progress);
    report.warnings(&made.warnings);
    if args.answer.json {
        let camera = |camera: &sinew_analysis::segment::CameraMasks| {
            json!({
                "name": camera.name,
                "background_images": camera.background_images,
                "masks": camera.masks,
                "mean_share": camera.mean_share,
            })
        };
        report::answer_json(&json!({ "out": out, "cameras": made.cameras.iter().map(camera).collect::<Vec<_>>() }))?;
    } else {
        let line = |camera: &sinew_analysis::segment::CameraMasks| {
            format!(
                "{}: {} masks, {:.1} % of the image on average ({} images of the background)\n",
                camera.name,
                camera.masks,
                100.0 * camera.mean_share,
                camera.background_images
            )
        };
        report::answer(&made.cameras.iter().map(line).collect::<String>())?;
    }
    Ok(Ended::Done)
}
