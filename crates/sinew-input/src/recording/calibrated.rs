//! The cameras of a calibration file, and the chosen ones.

use crate::input_error::InputError;
use crate::{Error, files};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_formats::{calibration, camera_name};
use sinew_observe::Camera;
use std::path::Path;

/// The cameras of a calibration file.
pub struct Calibrated {
    /// Cameras, in the order of the file.
    pub cameras: Vec<Camera>,
    /// Names of all of them.
    pub names: Vec<String>,
    /// What is odd in the file.
    pub warnings: Vec<String>,
    /// Hash of its text.
    pub hash: u64,
}

impl Calibrated {
    /// Reads a calibration of any format.
    ///
    /// # Errors
    /// A file that cannot be read, and what [`calibration::read`] refuses.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = files::read_text(path, MAX_CONFIG_BYTES)?;
        let read = calibration::read(&path.display().to_string(), &text)?;
        Ok(Self {
            names: read.cameras.iter().map(|camera| camera.name.clone()).collect(),
            cameras: read.cameras,
            warnings: read.warnings.iter().map(ToString::to_string).collect(),
            hash: files::fnv(files::FNV_START, text.as_bytes()),
        })
    }
}

/// The cameras of some names.
pub fn chosen_cameras(cameras: Vec<Camera>, names: &[String]) -> Result<Vec<Camera>, Error> {
    for name in names {
        let wanted = camera_name::fold(name);
        if !cameras.iter().any(|camera| camera_name::fold(&camera.name) == wanted) {
            let calibrated = cameras.into_iter().map(|camera| camera.name).collect();
            return Err(InputError::NoSuchCamera { name: name.clone(), calibrated }.into());
        }
    }
    let wanted: Vec<String> = names.iter().map(|name| camera_name::fold(name)).collect();
    Ok(cameras.into_iter().filter(|camera| wanted.contains(&camera_name::fold(&camera.name))).collect())
}
