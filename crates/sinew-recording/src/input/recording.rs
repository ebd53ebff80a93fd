//! A recording on disk: keypoint folders `<camera>_json/*.json` of calibrated cameras, read one frame at a time.
//!
//! [`Recording::open`] lists the files, matches folders to cameras by name and checks what can be checked without reading every file; [`Recording::frame`] reads
//! the files of one frame. What is odd about single frames is counted, each frame once however often it is read; [`Recording::warnings`] has the counts.
//!
//! Frames go by the number in the file names. A number without a file is a frame that the camera missed.

mod calibrated;
mod frame_ranges;
mod guess;
mod known_layout;
pub mod listing;
mod options;
pub mod survey;

pub use calibrated::{Calibrated, chosen_cameras};
pub use frame_ranges::{check_lags, lag_of, ranges};
pub use known_layout::{check_layout, lacking};
pub use options::RecordingOptions;

use crate::{Error, files};
use known_layout::named_layout;
use listing::{CameraFiles, chosen_folders};
use sinew_formats::openpose::{self, OpenposePerson, Tally};
use sinew_formats::source_text::MAX_KEYPOINT_BYTES;
use sinew_formats::{Layout, camera_name, frame_number};
use sinew_observe::Camera;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// An opened recording.
#[derive(Debug)]
pub struct Recording {
    cameras: Vec<Camera>,
    calibrated: Vec<String>,
    files: Vec<CameraFiles>,
    layout: Layout,
    confidence_scale: f64,
    image_scale: f64,
    lag: Vec<(String, i64)>,
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
        let Calibrated { cameras, names: calibrated, mut warnings, hash: calibration_hash } =
            Calibrated::read(calibration)?;
        let folders = listing::camera_folders(keypoints)?;
        let (cameras, folders) = match options.cameras.as_deref() {
            Some(names) => (chosen_cameras(cameras, names)?, chosen_folders(folders, names)?),
            None => (cameras, folders),
        };

        let names: Vec<&str> = folders.iter().map(|folder| folder.name.as_str()).collect();
        check_lags(&options.lag, &calibrated)?;
        let camera_names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        let matching = camera_name::match_names(&names, &camera_names)?;
        warnings.extend(matching.warnings(&names, &camera_names).iter().map(ToString::to_string));
        let mut folders: Vec<Option<listing::Folder>> = folders.into_iter().map(Some).collect();
        let mut used = Vec::new();
        let mut listed = Vec::new();
        for (folder, camera) in matching.pairs {
            let Some(folder) = folders.get_mut(folder).and_then(Option::take) else { continue };
            let name = &cameras[camera].name;
            let files = listing::files(folder, name, "keypoint files")?;
            listed.push(files.late_by(lag_of(&options.lag, name)));
            used.push(cameras[camera].resized(options.image_scale));
        }
        if used.len() == 1 {
            warnings.push("one camera: depth comes from the prior only".into());
        }

        let (available, frames) = ranges(&listed, options.frames.as_ref(), options.trim)?;
        warnings.extend(range_warnings(&listed, options, &frames));
        let (layout, layout_note) = match &options.layout {
            Some(name) => (named_layout(name)?, None),
            None => guess::layout(&listed, keypoints)?,
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
            files: listed,
            layout,
            confidence_scale: options.confidence_scale,
            image_scale: options.image_scale,
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

    /// Frames that cameras are late, as declared.
    #[must_use]
    pub fn lag(&self) -> &[(String, i64)] {
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

    /// People in each camera's view, in the order of [`Recording::cameras`]; nobody where a camera has no file.
    ///
    /// # Errors
    /// Files that cannot be read, or that [`openpose::read`] refuses.
    pub fn frame(&mut self, number: u64) -> Result<Vec<Vec<OpenposePerson>>, Error> {
        let slot = number.checked_sub(self.frames.start).and_then(|i| self.counted.get_mut(usize::try_from(i).ok()?));
        let count = slot.is_some_and(|counted| !std::mem::replace(counted, true));
        let mut views = Vec::with_capacity(self.files.len());
        for (index, (files, tally)) in self.files.iter().zip(&mut self.tallies).enumerate() {
            let frame = match files.path(number) {
                Some(path) => {
                    let text = files::read_text(&path, MAX_KEYPOINT_BYTES)?;
                    if count {
                        // A sum does not depend on the order in which frames are read.
                        let place =
                            files::fnv(files::fnv(files::FNV_START, &number.to_le_bytes()), &index.to_le_bytes());
                        self.keypoints_hash = self.keypoints_hash.wrapping_add(files::fnv(place, text.as_bytes()));
                    }
                    let options = openpose::OpenposeOptions {
                        frame: Some(number),
                        layout: Some(&self.layout),
                        confidence_scale: self.confidence_scale,
                    };
                    Some(openpose::read(&path.display().to_string(), &text, &options)?)
                }
                None => None,
            };
            if count {
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
        self.files.iter().map(|files| files.folder.clone()).collect()
    }
}

/// Warnings about frames that are requested or trimmed, and about holes.
fn range_warnings(listed: &[CameraFiles], options: &RecordingOptions, frames: &Range<u64>) -> Vec<String> {
    let mut warnings = vec![];
    if let Some(asked) = options.frames.as_ref().filter(|asked| asked.start < frames.start || asked.end > frames.end) {
        warnings.push(format!(
            "frames {}..{} were requested; {}..{} are there and taken",
            asked.start, asked.end, frames.start, frames.end
        ));
    }
    if options.trim && options.frames.is_none() {
        for camera in listed.iter().filter(|camera| camera.range() != *frames) {
            let Range { start, end } = camera.range();
            warnings.push(format!(
                "{} has frames {start}..{end}; trimmed to {}..{}, which all cameras have",
                camera.camera, frames.start, frames.end
            ));
        }
    }
    for camera in listed {
        let numbers: Vec<u64> = camera.numbers().filter(|number| frames.contains(number)).collect();
        warnings.extend(frame_number::holes(&camera.camera, &numbers).map(|warning| warning.to_string()));
    }
    warnings
}

/// Makes keypoints missing that no ray of the camera's lens model leads to, and counts them.
fn drop_beyond_lens(camera: &Camera, people: &mut [OpenposePerson]) -> u64 {
    let mut dropped = 0;
    for keypoint in people.iter_mut().flat_map(|person| &mut person.keypoints) {
        if keypoint.is_some_and(|point| camera.undistort([point.x, point.y]).is_err()) {
            *keypoint = None;
            dropped += 1;
        }
    }
    dropped
}
