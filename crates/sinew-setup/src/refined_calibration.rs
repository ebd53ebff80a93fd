//! A calibration as the set-up of a run refined it.
//!
//! Each camera of the set-up is moved by the posterior mean of its error ([`sinew_observe::cameras::camera_error`]). Errors hold in the frame of the camera and for images of any size, so that they are put onto the cameras of the file itself: the world stays as the file has it, also where
//! the run turned it to z up, and images keep the calibrated size, also where those with the keypoints were resized. The common shift of all cameras, which no keypoint shows, stays in.
//!
//! What the file holds beside cameras is not written again.

use crate::Error;
use crate::Setup;
use sinew_formats::calib_toml;
use sinew_input::recording::Calibrated;
use sinew_observe::Camera;
use std::path::Path;

/// A refined calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct RefinedCalibration {
    /// Cameras in the order of the file.
    pub cameras: Vec<Camera>,
    /// Names of those that the set-up does not know, which stay as they were.
    pub unchanged: Vec<String>,
}

impl RefinedCalibration {
    /// Reads a calibration and refines it; `image_scale` is the size of the images of the set-up over that of the calibrated ones.
    ///
    /// # Errors
    /// A calibration that cannot be read.
    pub fn read(calibration: &Path, setup: &Setup, image_scale: f64) -> Result<Self, Error> {
        let cameras = Calibrated::read(calibration)?.cameras;
        let is_known = |name: &str| setup.camera.iter().any(|known| known.name == name);
        let unchanged = cameras.iter().map(|camera| camera.name.clone()).filter(|name| !is_known(name)).collect();
        Ok(Self { cameras: setup.as_they_are(&cameras, image_scale.recip()), unchanged })
    }

    /// The text of the file, in the format of `Calib.toml`.
    #[must_use]
    pub fn to_toml(&self) -> String {
        format!(
            "# Cameras moved by the mean of their errors, as the set-up of sinew {} found them.\n{}",
            env!("CARGO_PKG_VERSION"),
            calib_toml::write(&self.cameras)
        )
    }
}
