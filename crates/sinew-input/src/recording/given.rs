//! Keypoints and cameras that are in memory already, in place of files.

use sinew_formats::keypoint_table::Frames;
use sinew_formats::{Layout, calib_toml};
use sinew_observe::Camera;

use super::calibrated::Calibrated;
use super::keypoint_sources::KeypointSource;
use crate::files;

/// A recording in memory.
#[derive(Clone, Debug)]
pub struct GivenRecording {
    /// Calibrated cameras.
    pub cameras: Vec<Camera>,
    /// Frames of each camera, by number.
    pub frames: Vec<Frames>,
    /// Meaning of the keypoint indices; to be guessed from their number if `None`.
    pub layout: Option<Layout>,
}

impl GivenRecording {
    /// The cameras, as a calibration file would have them.
    pub(super) fn calibrated(&self) -> Calibrated {
        Calibrated {
            names: self.cameras.iter().map(|camera| camera.name.clone()).collect(),
            cameras: self.cameras.clone(),
            warnings: vec![],
            hash: files::fnv(files::FNV_START, calib_toml::write(&self.cameras).as_bytes()),
        }
    }

    /// The keypoints of each camera.
    pub(super) fn sources(&self) -> Vec<KeypointSource> {
        let given = self.cameras.iter().zip(&self.frames);
        given.map(|(camera, frames)| KeypointSource::given(&camera.name, frames.clone(), self.layout.clone())).collect()
    }
}
