//! A recording on disk: keypoints of calibrated cameras, read one frame at a time.
//!
//! [`Recording::open`] lists the files ([`keypoint_sources`]), matches them to cameras by name and checks what can be checked without reading every file; [`Recording::frame`] reads
//! the files of one frame. What is odd about single frames is counted, each frame once however often it is read; [`Recording::warnings`] has the counts.
//!
//! Frames go by the number in the file names. A number without a file is a frame that the camera missed. What a camera shows that is late by part of a frame, [`Recording::people`]
//! interpolates between its frames.

mod calibrated;
mod frame_ranges;
pub mod given;
pub(super) mod guess;
pub mod keypoint_camera;
pub mod keypoint_sources;
pub(super) mod known_layout;
pub mod listing;
mod options;
pub mod read_frames;
mod recent_frames;
pub mod survey;

pub use calibrated::{Calibrated, chosen_cameras};
pub use frame_ranges::{check_lags, lag_of, ranges};
pub use known_layout::{check_layout, lacking};
pub use options::RecordingOptions;

use crate::lag::ClockLag;
use crate::{Error, files};
use given::GivenRecording;
use keypoint_camera::KeypointCamera;
use keypoint_sources::KeypointSource;
use known_layout::named_layout;
use read_frames::ReadFrames;
use recent_frames::RecentFrames;
use sinew_formats::openpose::{OpenposeOptions, OpenposePerson, Tally, detections};
use sinew_formats::{Layout, camera_name, frame_number};
use sinew_observe::Camera;
use sinew_observe::association::Person;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An opened recording.
#[derive(Debug)]
pub struct Recording {
    cameras: Vec<Camera>,
    calibrated: Vec<String>,
    keypoints: Vec<KeypointCamera>,
    layout: Layout,
    confidence_scale: f64,
    read_before: Arc<ReadFrames>,
    image_scale: f64,
    lag: Vec<(String, ClockLag)>,
    recent: Vec<RecentFrames>,
    available: Range<u64>,
    frames: Range<u64>,
    counted: Vec<bool>,
    tallies: Vec<Tally>,
    beyond_lens: Vec<u64>,
    warnings: Vec<String>,
    layout_note: Option<String>,
    calibration_hash: u64,
    keypoints_hash: u64,
}

impl Recording {
    /// Opens the keypoint folder of the cameras in a calibration file.
    ///
    /// # Errors
    /// What [`sinew_formats::calibration::read`] refuses; folders that do not fit the calibration; cameras that begin or end apart, unless trimmed; an empty selection; a layout
    /// that is unknown or too poor.
    pub fn open(calibration: &Path, keypoints: &Path, options: &RecordingOptions) -> Result<Self, Error> {
        let calibrated = Calibrated::read(calibration)?;
        let sources = keypoint_sources::sources(keypoints, &calibrated.names, options.confidence_scale)?;
        Self::from_sources(calibrated, sources, keypoints, options)
    }

    /// Opens a recording in memory.
    ///
    /// # Errors
    /// As [`Recording::open`], but for files.
    pub fn given(given: &GivenRecording, options: &RecordingOptions) -> Result<Self, Error> {
        Self::from_sources(given.calibrated(), given.sources(), Path::new("keypoints"), options)
    }

    fn from_sources(
        calibrated: Calibrated,
        sources: Vec<KeypointSource>,
        keypoints: &Path,
        options: &RecordingOptions,
    ) -> Result<Self, Error> {
        let Calibrated { cameras, names: calibrated, mut warnings, hash: calibration_hash } = calibrated;
        let (cameras, sources) = match options.cameras.as_deref() {
            Some(names) => (chosen_cameras(cameras, names)?, keypoint_sources::chosen(sources, names)?),
            None => (cameras, sources),
        };
        let said = keypoint_sources::layout(&sources)?;

        check_lags(&options.lag, &calibrated)?;
        let (used, listed) = matched(&cameras, sources, options, &mut warnings)?;
        if used.len() == 1 {
            warnings.push("one camera: depth comes from the prior only".into());
        }

        let (available, frames) = ranges(&listed, options.frames.as_ref(), options.trim)?;
        warnings.extend(range_warnings(&listed, options, &frames));
        let (layout, layout_note) = match (&options.layout, said) {
            (Some(name), _) => (named_layout(name)?, None),
            (None, Some(layout)) => (layout, None),
            (None, None) => guess::layout(&listed, keypoints)?,
        };
        if options.layout.is_some() {
            warnings.extend(guess::contradiction(&listed, &layout));
        }
        check_layout(&layout)?;
        Ok(Self {
            tallies: vec![Tally::default(); used.len()],
            beyond_lens: vec![0; used.len()],
            counted: vec![false; (frames.end - frames.start) as usize],
            cameras: used,
            calibrated,
            layout,
            confidence_scale: options.confidence_scale,
            read_before: Arc::clone(&options.read_before),
            image_scale: options.image_scale,
            recent: listed.iter().map(|_| RecentFrames::default()).collect(),
            keypoints: listed,
            lag: options.lag.clone(),
            available,
            frames,
            warnings,
            layout_note,
            calibration_hash,
            keypoints_hash: 0,
        })
    }

    /// Cameras with keypoints, in the order of the calibration.
    #[must_use]
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// Names of all cameras in the calibration, those without keypoints included.
    #[must_use]
    pub fn calibrated(&self) -> &[String] {
        &self.calibrated
    }

    /// Size of the images over that of the calibrated ones; the cameras are resized by it.
    #[must_use]
    pub const fn image_scale(&self) -> f64 {
        self.image_scale
    }

    /// How late cameras are, as declared.
    #[must_use]
    pub fn lag(&self) -> &[(String, ClockLag)] {
        &self.lag
    }

    /// Meaning of the keypoint indices.
    #[must_use]
    pub const fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Frames to be tracked.
    #[must_use]
    pub fn frames(&self) -> Range<u64> {
        self.frames.clone()
    }

    /// Frames that exist, from which a set-up may take others than those to be tracked.
    #[must_use]
    pub fn available(&self) -> Range<u64> {
        self.available.clone()
    }

    /// People in each camera's view, in the order of [`Recording::cameras`], interpolated where its frames lie between; nobody where a camera has no file.
    ///
    /// # Errors
    /// As for [`Recording::frame`].
    pub fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let mut people = detections(&self.frame(number)?);
        let Self { keypoints, cameras, layout, confidence_scale, read_before, recent, .. } = self;
        for (index, (keypoints, recent)) in keypoints.iter().zip(recent).enumerate() {
            let lag = keypoints.files().lag;
            if lag.is_whole() {
                continue;
            }
            let read = |own| {
                let options = options(own, layout, *confidence_scale);
                let mut people = keypoints
                    .read_once(own, &options, 0, read_before)?
                    .map(|(frame, _)| frame.people)
                    .unwrap_or_default();
                drop_beyond_lens(&cameras[index], &mut people);
                Ok(people.iter().map(OpenposePerson::detections).collect())
            };
            people[index] = recent.people_at(lag.own_time(number), read)?;
        }
        Ok(people)
    }

    /// As [`Recording::people`], but for each camera what it read of its frame that is nearest in time.
    ///
    /// # Errors
    /// Files that cannot be read, or that their reader refuses.
    pub fn frame(&mut self, number: u64) -> Result<Vec<Vec<OpenposePerson>>, Error> {
        let slot = number.checked_sub(self.frames.start).and_then(|i| self.counted.get_mut(usize::try_from(i).ok()?));
        let count = slot.is_some_and(|counted| !std::mem::replace(counted, true));
        let mut views = Vec::with_capacity(self.keypoints.len());
        for (index, (keypoints, tally)) in self.keypoints.iter().zip(&mut self.tallies).enumerate() {
            let place = files::fnv(files::fnv(files::FNV_START, &number.to_le_bytes()), &index.to_le_bytes());
            let own = keypoints.files().lag.nearest(number);
            let read = own.map(|own| {
                let options = options(own, &self.layout, self.confidence_scale);
                keypoints.read_once(own, &options, place, &self.read_before)
            });
            let read = read.transpose()?.flatten();
            if let Some((_, hash)) = read.as_ref().filter(|_| count) {
                // A sum does not depend on the order in which frames are read.
                self.keypoints_hash = self.keypoints_hash.wrapping_add(*hash);
            }
            let frame = read.map(|(frame, _)| frame);
            // A frame without a file is a hole in the numbers, which has a warning of its own.
            if count && (frame.is_some() || keypoints.files().leaves_out_nobody) {
                tally.add(number, frame.as_ref());
            }
            let mut people = frame.map(|frame| frame.people).unwrap_or_default();
            let dropped = drop_beyond_lens(&self.cameras[index], &mut people);
            if count {
                self.beyond_lens[index] += dropped;
            }
            views.push(people);
        }
        Ok(views)
    }

    /// What is odd about the recording as far as it was read, and what was guessed.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        self.layout_note.iter().cloned().chain(self.oddities()).collect()
    }

    /// What is odd about the recording as far as it was read.
    #[must_use]
    pub fn oddities(&self) -> Vec<String> {
        let counted = self.cameras.iter().zip(&self.tallies).flat_map(|(camera, tally)| tally.warnings(&camera.name));
        let lens = self.cameras.iter().zip(&self.beyond_lens).filter(|(_, points)| **points > 0);
        let lens = lens.map(|(camera, points)| {
            format!(
                "{}: {points} points lie beyond the valid radius of the lens model; treated as missing",
                camera.name
            )
        });
        self.warnings.iter().cloned().chain(counted.map(|warning| warning.to_string())).chain(lens).collect()
    }

    /// Hashes of the calibration and of the keypoints read so far.
    #[must_use]
    pub fn input_hashes(&self) -> BTreeMap<String, String> {
        let hashes = [("calibration", self.calibration_hash), ("keypoints", self.keypoints_hash)];
        hashes.map(|(name, hash)| (name.to_owned(), format!("{hash:016x}"))).into()
    }

    /// Files and folders that the recording is read from.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        self.keypoints.iter().map(KeypointCamera::source).collect()
    }
}

/// The cameras with keypoints, resized, and the keypoints of each.
fn matched(
    cameras: &[Camera],
    sources: Vec<KeypointSource>,
    options: &RecordingOptions,
    warnings: &mut Vec<String>,
) -> Result<(Vec<Camera>, Vec<KeypointCamera>), Error> {
    let names: Vec<&str> = sources.iter().map(|source| source.name.as_str()).collect();
    let camera_names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
    let matching = camera_name::match_names(&names, &camera_names)?;
    warnings.extend(matching.warnings(&names, &camera_names).iter().map(ToString::to_string));
    let mut sources: Vec<Option<KeypointSource>> = sources.into_iter().map(Some).collect();
    let (mut used, mut listed) = (Vec::new(), Vec::new());
    for (source, camera) in matching.pairs {
        let Some(source) = sources.get_mut(source).and_then(Option::take) else { continue };
        let camera = cameras[camera].resized(options.image_scale);
        warnings.extend(source.warnings.iter().cloned());
        let keypoints = source.keypoints(&camera.name, Some(&camera))?;
        listed.push(keypoints.late_by(lag_of(&options.lag, &camera.name)));
        used.push(camera);
    }
    Ok((used, listed))
}

/// Warnings about frames that are requested or trimmed, and about holes.
fn range_warnings(listed: &[KeypointCamera], options: &RecordingOptions, frames: &Range<u64>) -> Vec<String> {
    let listed = || listed.iter().map(KeypointCamera::files);
    let mut warnings = vec![];
    if let Some(asked) = options.frames.as_ref().filter(|asked| asked.start < frames.start || asked.end > frames.end) {
        warnings.push(format!(
            "frames {}..{} were requested; {}..{} are there and taken",
            asked.start, asked.end, frames.start, frames.end
        ));
    }
    if options.trim && options.frames.is_none() {
        for camera in listed().filter(|camera| camera.len() > 0 && camera.range() != *frames) {
            let Range { start, end } = camera.range();
            warnings.push(format!(
                "{} has frames {start}..{end}; trimmed to {}..{}, which all cameras have",
                camera.camera, frames.start, frames.end
            ));
        }
    }
    for camera in listed().filter(|camera| !camera.leaves_out_nobody) {
        let numbers: Vec<u64> = camera.numbers().filter(|number| frames.contains(number)).collect();
        warnings.extend(frame_number::holes(&camera.camera, &numbers).map(|warning| warning.to_string()));
    }
    warnings
}

const fn options(own: u64, layout: &Layout, confidence_scale: f64) -> OpenposeOptions<'_> {
    OpenposeOptions { frame: Some(own), layout: Some(layout), confidence_scale }
}

/// Makes keypoints missing that no ray of the camera's lens model leads to, and counts them.
pub(super) fn drop_beyond_lens(camera: &Camera, people: &mut [OpenposePerson]) -> u64 {
    let mut dropped = 0;
    for keypoint in people.iter_mut().flat_map(|person| &mut person.keypoints) {
        if keypoint.is_some_and(|point| camera.undistort([point.x, point.y]).is_err()) {
            *keypoint = None;
            dropped += 1;
        }
    }
    dropped
}
