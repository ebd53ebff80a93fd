//! The keypoints of a camera, from a file a frame or from one file of many frames.
//!
//! A file that holds many is read once, when the recording is opened, and its keypoints stay in memory.

use super::listing::CameraFiles;
use super::read_frames::ReadFrames;
use crate::lag::ClockLag;
use crate::{Error, files};
use sinew_formats::keypoint_table::Frames;
use sinew_formats::openpose::{self, OpenposeFrame, OpenposeOptions};
use sinew_formats::source_text::MAX_KEYPOINT_BYTES;
use sinew_formats::{Place, keypoint_formats};
use sinew_observe::Camera;
use std::borrow::Borrow;
use std::path::{Path, PathBuf};

/// The keypoints of a camera.
#[derive(Debug)]
pub struct KeypointCamera {
    files: CameraFiles,
    /// Frames by the numbers of the file, for one file of many frames.
    table: Option<Frames>,
}

impl Borrow<CameraFiles> for KeypointCamera {
    fn borrow(&self) -> &CameraFiles {
        &self.files
    }
}

impl KeypointCamera {
    /// A folder with a file a frame.
    #[must_use]
    pub const fn folder(files: CameraFiles) -> Self {
        Self { files, table: None }
    }

    /// Frames of a file; coordinates that are shares of the image become pixels of the camera.
    #[must_use]
    pub fn table(files: CameraFiles, mut frames: Frames, shares_of: Option<&Camera>) -> Self {
        if let Some(camera) = shares_of {
            let [width, height] = camera.image_size_px;
            let people = frames.values_mut().flat_map(|frame| &mut frame.people);
            for keypoint in people.flat_map(|person| person.keypoints.iter_mut().flatten()) {
                (keypoint.x, keypoint.y) = (keypoint.x * width, keypoint.y * height);
            }
        }
        Self { files, table: Some(frames) }
    }

    /// The same keypoints of a camera that is late.
    #[must_use]
    pub fn late_by(self, lag: ClockLag) -> Self {
        Self { files: self.files.late_by(lag), ..self }
    }

    /// Files or frames by number.
    #[must_use]
    pub const fn files(&self) -> &CameraFiles {
        &self.files
    }

    /// Whether one file holds all frames.
    #[must_use]
    pub const fn is_table(&self) -> bool {
        self.table.is_some()
    }

    /// What the keypoints are read from.
    #[must_use]
    pub fn source(&self) -> PathBuf {
        let file = self.files.file().filter(|_| self.is_table());
        file.unwrap_or_else(|| self.files.folder.clone())
    }

    /// What was seen in one of the camera's own frames, and a hash of it that begins with `hash`; `None` for a frame that it missed.
    ///
    /// # Errors
    /// A file that cannot be read or is refused, people who do not fit the layout.
    pub fn read(
        &self,
        own: u64,
        options: &OpenposeOptions<'_>,
        hash: u64,
    ) -> Result<Option<(OpenposeFrame, u64)>, Error> {
        let Some(path) = self.files.own_path(own) else { return Ok(None) };
        let Some(frames) = &self.table else { return Self::read_file(&path, options, hash).map(Some) };
        let Some(frame) = frames.get(&own) else { return Ok(None) };
        let name = path.display().to_string();
        openpose::check_people(&Place::file(&name).within(format!("frame {own}")), frame, options.layout)?;
        Ok(Some((frame.clone(), hashed(frame, hash))))
    }

    /// As [`KeypointCamera::read`], with files a frame that stay in memory once they were read.
    ///
    /// # Errors
    /// As [`KeypointCamera::read`].
    pub fn read_once(
        &self,
        own: u64,
        options: &OpenposeOptions<'_>,
        hash: u64,
        before: &ReadFrames,
    ) -> Result<Option<(OpenposeFrame, u64)>, Error> {
        match self.files.own_path(own).filter(|_| !self.is_table()) {
            None => self.read(own, options, hash),
            Some(path) => before.frame(&path, hash, || Self::read_file(&path, options, hash)).map(Some),
        }
    }

    fn read_file(path: &Path, options: &OpenposeOptions<'_>, hash: u64) -> Result<(OpenposeFrame, u64), Error> {
        let text = files::read_text(path, MAX_KEYPOINT_BYTES)?;
        let frame = keypoint_formats::read_frame(&path.display().to_string(), &text, options)?;
        Ok((frame, files::fnv(hash, text.as_bytes())))
    }
}

/// A hash of the keypoints of a frame.
fn hashed(frame: &OpenposeFrame, hash: u64) -> u64 {
    frame.people.iter().fold(hash, |hash, person| {
        let keypoints = person.keypoints.iter().enumerate().filter_map(|(index, keypoint)| Some((index, (*keypoint)?)));
        let index = files::fnv(hash, &(person.index as u64).to_le_bytes());
        keypoints.fold(index, |hash, (index, keypoint)| {
            let numbers = [index as u64, keypoint.x.to_bits(), keypoint.y.to_bits(), keypoint.confidence.to_bits()];
            numbers.iter().fold(hash, |hash, number| files::fnv(hash, &number.to_le_bytes()))
        })
    })
}
