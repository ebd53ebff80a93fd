//! The kinds of files and folders that can be inspected.

use std::path::PathBuf;

/// What a path leads to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Calibration file.
    Calibration(PathBuf),
    /// Set-up of a run.
    Setup(PathBuf),
    /// Configuration.
    Configuration(PathBuf),
    /// Body file.
    Body(PathBuf),
    /// Mapping of keypoints.
    Layout(PathBuf),
    /// Keypoint folder.
    Keypoints(PathBuf),
    /// Folder of masks or images.
    Images(PathBuf),
    /// Motion file or table of a result folder.
    Motion(PathBuf),
    /// Actions of a run.
    Actions(PathBuf),
    /// Acclaim skeleton.
    Skeleton(PathBuf),
    /// Acclaim motion.
    Acclaim {
        /// AMC file.
        motion: PathBuf,
        /// ASF file.
        skeleton: Option<PathBuf>,
    },
    /// Motion model.
    MotionModel(PathBuf),
    /// Latent model.
    LatentModel(PathBuf),
    /// Result folder.
    Results(PathBuf),
    /// Zarr store.
    Draws(PathBuf),
}
