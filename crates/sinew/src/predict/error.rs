//! Why nothing can be predicted for a camera.

use std::path::PathBuf;

/// A result, calibration or camera that gives no prediction.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PredictError {
    /// Results without draws of keypoints in space.
    #[error("{}: no draws of where keypoints lie in space", .0.display())]
    NoKeypoints(PathBuf),
    /// Files of different runs.
    #[error("{}: posterior.zarr, setup.toml and frames.csv are of different runs", .0.display())]
    OtherRun(PathBuf),
    /// A camera that is not calibrated.
    #[error("{}: no camera `{camera}`; calibrated are: {}", calibration.display(), calibrated.join(", "))]
    UnknownCamera {
        /// Calibration.
        calibration: PathBuf,
        /// Requested name.
        camera: String,
        /// Names that it has.
        calibrated: Vec<String>,
    },
    /// A camera that is part of the run.
    #[error("the run, or its set-up, used camera `{0}`; what it sees is no prediction")]
    UsedCamera(String),
}

impl PredictError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::UnknownCamera { .. } | Self::UsedCamera(_) => 2,
            Self::NoKeypoints(_) | Self::OtherRun(_) => 3,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        let help = match self {
            Self::NoKeypoints(_) => "track again from keypoints, with a set-up of this version",
            Self::OtherRun(_) => "track again into an empty folder",
            Self::UnknownCamera { .. } => "`sinew inspect` lists the cameras of a calibration",
            Self::UsedCamera(_) => {
                "track with the other cameras (`--cameras`), or use `sinew validate`, which does that"
            }
        };
        Some(help.into())
    }
}
