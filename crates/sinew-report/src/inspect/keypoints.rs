//! What a keypoint folder holds, from an evenly spaced part of its files.

use super::facts::{Facts, Odd};
use crate::Error;
use sinew::input::recording::RecordingOptions;
use sinew::input::recording::survey::{CameraSurvey, Oddity, survey};
use std::path::Path;

pub(super) fn facts(path: &Path, options: &RecordingOptions) -> Result<Facts, Error> {
    let survey = survey(path, options)?;
    let mut facts = Facts::new(format!("{}: keypoints of {} cameras", path.display(), survey.cameras.len()));
    let guess = if survey.is_guess { ", by the place of the hips" } else { "" };
    facts.row("layout", format!("{}, {} keypoints{guess}", survey.layout.name, survey.layout.points.len()));
    for camera in &survey.cameras {
        facts.row(&camera.name, line(camera));
    }
    facts.odd.extend(survey.odd.into_iter().map(|odd| match odd {
        Oddity::Words(words) => Odd::Words(words),
        Oddity::Refused(error) => Odd::Refused(error),
    }));
    facts.odd.extend(apart(&survey.cameras).filter(|_| !options.trim));
    Ok(facts)
}

/// Cameras that begin or end apart, which tracking refuses.
fn apart(cameras: &[CameraSurvey]) -> Option<Odd> {
    let mut whole = cameras.iter().filter(|camera| !camera.leaves_out_nobody);
    let first = whole.next()?;
    let other = whole.find(|camera| (camera.first, camera.end) != (first.first, first.end))?;
    Some(Odd::Apart([first, other].map(|camera| (camera.name.clone(), camera.first..camera.end))))
}

fn line(camera: &CameraSurvey) -> String {
    let people = match (camera.fewest, camera.most) {
        (1, 1) => "1 person".into(),
        (a, b) if a == b => format!("{a} people"),
        (a, b) => format!("{a} to {b} people"),
    };
    let [left, top, right, bottom] = camera.bounds;
    let seen = if left > right {
        String::new()
    } else if camera.in_image_shares {
        format!(", shares of the image {left:.2} to {right:.2} by {top:.2} to {bottom:.2}")
    } else {
        format!(", pixels {left:.0} to {right:.0} by {top:.0} to {bottom:.0}")
    };
    let what = if camera.is_table { "frames in one file" } else { "files" };
    format!("{} {what}, frames {}..{}, {people}{seen}", camera.files, camera.first, camera.end)
}
