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
