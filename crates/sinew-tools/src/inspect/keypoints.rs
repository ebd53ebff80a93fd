//! What a keypoint folder holds, from an evenly spaced part of its files.

use super::facts::Facts;
use crate::Error;
use sinew::input::recording::RecordingOptions;
use sinew::input::recording::survey::{CameraSurvey, survey};
use std::path::Path;

pub(super) fn facts(path: &Path, options: &RecordingOptions) -> Result<Facts, Error> {
    let survey = survey(path, options)?;
    let mut facts = Facts::new(format!("{}: keypoints of {} cameras", path.display(), survey.cameras.len()));
    let guess = if survey.is_guess { ", by the place of the hips" } else { "" };
    facts.row("layout", format!("{}, {} keypoints{guess}", survey.layout.name, survey.layout.points.len()));
    for camera in &survey.cameras {
        facts.row(&camera.name, line(camera));
    }
    facts.odd.extend(survey.warnings);
    let first = survey.cameras.first().map(|camera| (camera.first, camera.end));
    let apart = survey.cameras.iter().find(|camera| Some((camera.first, camera.end)) != first);
    if let Some(other) = apart.filter(|_| !options.trim) {
        let (start, end) = first.unwrap_or_default();
        facts.odd.push(format!(
            "{} has frames {start}..{end}, {} has {}..{}; tracking needs `--trim`, and if cameras are numbered apart, `sinew sync --trim` finds by how much",
            survey.cameras[0].name, other.name, other.first, other.end
        ));
    }
    for camera in &survey.cameras {
        if 4 * camera.empty > camera.read {
            facts
                .odd
                .push(format!("{}: nobody in {} of {} frames that were read", camera.name, camera.empty, camera.read));
        }
    }
    Ok(facts)
}

fn line(camera: &CameraSurvey) -> String {
    let people = match (camera.fewest, camera.most) {
        (1, 1) => "1 person".into(),
        (a, b) if a == b => format!("{a} people"),
        (a, b) => format!("{a} to {b} people"),
    };
    let [left, top, right, bottom] = camera.bounds_px;
    let seen = if left <= right {
        format!(", pixels {left:.0} to {right:.0} by {top:.0} to {bottom:.0}")
    } else {
        String::new()
    };
    let what = if camera.is_table { "frames in one file" } else { "files" };
    format!("{} {what}, frames {}..{}, {people}{seen}", camera.files, camera.first, camera.end)
}
