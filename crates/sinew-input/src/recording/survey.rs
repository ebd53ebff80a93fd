//! A keypoint folder without a calibration: what its files hold, for `sinew inspect`.

use super::frame_ranges::{check_numbers, no_such_frames, spans};
use super::guess;
use super::keypoint_camera::KeypointCamera;
use super::keypoint_sources::{self, KeypointSource};
use super::known_layout::named_layout;
use super::listing::CameraFiles;
use super::options::RecordingOptions;
use crate::Error;
use crate::files::FNV_START;
use sinew_formats::openpose::{OpenposeFrame, OpenposeOptions, Tally};
use sinew_formats::{Layout, frame_number};
use std::path::Path;

/// Files of a camera that are read.
const READ: usize = 200;

/// What a keypoint folder holds.
#[derive(Debug)]
pub struct Survey {
    /// Meaning of the keypoint indices.
    pub layout: Layout,
    /// Whether other layouts fit as well.
    pub is_guess: bool,
    /// Its cameras, by name.
    pub cameras: Vec<CameraSurvey>,
    /// What is odd.
    pub odd: Vec<Oddity>,
}

/// Something odd about a keypoint folder.
#[derive(Debug)]
pub enum Oddity {
    /// In words.
    Words(String),
    /// Frames of cameras that a recording would be refused for.
    Refused(Error),
}

/// What a camera's folder holds.
#[derive(Clone, Debug)]
pub struct CameraSurvey {
    /// Name of the folder.
    pub name: String,
    /// Number of files, or of frames of one file, of the chosen frames.
    pub files: usize,
    /// Whether one file holds all frames.
    pub is_table: bool,
    /// Whether a frame that shows nobody is missing.
    pub leaves_out_nobody: bool,
    /// First frame.
    pub first: u64,
    /// Frame after the last.
    pub end: u64,
    /// Files read, evenly spaced.
    pub read: usize,
    /// Files without people among them.
    pub empty: usize,
    /// Least number of people in a file.
    pub fewest: usize,
    /// Greatest number of people in a file.
    pub most: usize,
    /// Left, top, right and bottom end of all keypoints, pixels or shares of the image.
    pub bounds: [f64; 4],
    /// Whether they are shares of the image.
    pub in_image_shares: bool,
}

/// Looks at a folder.
///
/// # Errors
/// A folder without keypoints, file names without numbers, an unknown layout, cameras or frames that are not there, files that cannot be read.
pub fn survey(keypoints: &Path, options: &RecordingOptions) -> Result<Survey, Error> {
    let mut sources = keypoint_sources::sources(keypoints, &[], options.confidence_scale)?;
    if let Some(names) = &options.cameras {
        sources = keypoint_sources::chosen(sources, names)?;
    }
    let said = keypoint_sources::layout(&sources)?;
    let mut listed = Vec::new();
    let (mut odd, mut warnings) = (Vec::new(), Vec::new());
    let in_image_shares = sources.iter().any(KeypointSource::in_image_shares);
    for source in sources {
        let name = source.name.clone();
        warnings.extend(source.warnings.iter().cloned());
        listed.push(source.keypoints(&name, None)?);
    }
    let (layout, guessed) = match (&options.layout, said) {
        (Some(name), _) => (named_layout(name)?, None),
        (None, Some(layout)) => (layout, None),
        (None, None) => guess::layout(&listed, keypoints)?,
    };
    if options.layout.is_some() {
        warnings.extend(guess::contradiction(&listed, &layout));
    }
    let is_wanted = |number: &u64| options.frames.as_ref().is_none_or(|asked| asked.contains(number));
    let spans = spans(&listed, CameraFiles::range).and_then(|spans| {
        spans.iter().try_for_each(|(_, span)| check_numbers(&listed, span))?;
        Ok(spans)
    });
    let spans = spans.unwrap_or_else(|error| {
        odd.extend(warnings.drain(..).map(Oddity::Words));
        odd.push(Oddity::Refused(error));
        vec![]
    });
    let numbers = |camera: &KeypointCamera| -> Vec<u64> {
        let span = spans.iter().find(|(name, _)| camera.files().leaves_out_nobody && *name == camera.files().camera);
        match span {
            Some((_, span)) => span.clone().filter(is_wanted).collect(),
            None => camera.files().numbers().filter(is_wanted).collect(),
        }
    };
    let numbers: Vec<Vec<u64>> = listed.iter().map(numbers).collect();
    if let Some(asked) = options.frames.as_ref().filter(|_| numbers.iter().all(Vec::is_empty)) {
        let ranges = || listed.iter().map(|camera| camera.files().range());
        let first = ranges().map(|range| range.start).min().unwrap_or_default();
        let end = ranges().map(|range| range.end).max().unwrap_or_default();
        return Err(no_such_frames(asked, &(first..end)));
    }
    let mut cameras = Vec::new();
    for (keypoints, numbers) in listed.iter().zip(&numbers) {
        warnings.extend(frame_number::holes(&keypoints.files().camera, numbers).map(|warning| warning.to_string()));
        let read = camera(keypoints, numbers, &layout, options.confidence_scale, &mut warnings)?;
        cameras.push(CameraSurvey { in_image_shares, ..read });
    }
    odd.extend(warnings.into_iter().map(Oddity::Words));
    Ok(Survey { layout, is_guess: guessed.is_some(), cameras, odd })
}

fn camera(
    keypoints: &KeypointCamera,
    numbers: &[u64],
    layout: &Layout,
    confidence_scale: f64,
    warnings: &mut Vec<String>,
) -> Result<CameraSurvey, Error> {
    let mut survey = CameraSurvey {
        name: keypoints.files().camera.clone(),
        files: numbers.iter().filter(|number| keypoints.files().path(**number).is_some()).count(),
        is_table: keypoints.is_table(),
        leaves_out_nobody: keypoints.files().leaves_out_nobody,
        first: numbers.first().copied().unwrap_or_default(),
        end: numbers.last().map_or(0, |last| last.saturating_add(1)),
        read: 0,
        empty: 0,
        fewest: usize::MAX,
        most: 0,
        bounds: [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY],
        in_image_shares: false,
    };
    let mut tally = Tally::default();
    for &number in numbers.iter().step_by(numbers.len().div_ceil(READ).max(1)) {
        let options = OpenposeOptions { frame: Some(number), layout: Some(layout), confidence_scale };
        let frame = match keypoints.read(number, &options, FNV_START)? {
            Some((frame, _)) => frame,
            None if survey.leaves_out_nobody => OpenposeFrame::default(),
            None => continue,
        };
        tally.add(number, Some(&frame));
        survey.read += 1;
        survey.empty += usize::from(frame.people.is_empty());
        survey.fewest = survey.fewest.min(frame.people.len());
        survey.most = survey.most.max(frame.people.len());
        let [left, top, right, bottom] = &mut survey.bounds;
        for point in frame.people.iter().flat_map(|person| person.keypoints.iter().flatten()) {
            (*left, *top) = (left.min(point.x), top.min(point.y));
            (*right, *bottom) = (right.max(point.x), bottom.max(point.y));
        }
    }
    survey.fewest = survey.fewest.min(survey.most);
    warnings.extend(tally.warnings(&keypoints.files().camera).iter().map(ToString::to_string));
    Ok(survey)
}
