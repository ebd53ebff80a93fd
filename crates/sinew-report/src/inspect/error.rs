//! What cannot be inspected.

use std::path::PathBuf;

/// Paths that cannot be inspected as they were given.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InspectError {
    /// A motion beside several skeletons.
    #[error("{} has one skeleton; given: {} and {}", motion.display(), first.display(), second.display())]
    TwoSkeletons {
        /// AMC file.
        motion: PathBuf,
        /// First skeleton.
        first: PathBuf,
        /// Second skeleton.
        second: PathBuf,
    },
    /// A file of no known kind.
    #[error("{}: nothing that can be inspected", path.display())]
    UnknownKind {
        /// File.
        path: PathBuf,
    },
    /// A video, which shows nothing without a detector.
    #[error("{}: a video", path.display())]
    Video {
        /// File.
        path: PathBuf,
    },
    /// A motion that does not say where points are.
    #[error("{}: coordinates of a body, no points", path.display())]
    NoPoints {
        /// File.
        path: PathBuf,
    },
    /// A truth of another motion.
    #[error("{}: no point at a time that {} has, too", truth.display(), found.display())]
    OtherMotion {
        /// What was found.
        found: PathBuf,
        /// The truth.
        truth: PathBuf,
    },
    /// A folder that is no store of draws.
    #[error("{}: no `{document}`; expected a Zarr store of format 3", folder.display())]
    NoStore {
        /// Folder.
        folder: PathBuf,
        /// File that every store has.
        document: &'static str,
    },
}

impl InspectError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::NoStore { .. } | Self::NoPoints { .. } | Self::OtherMotion { .. } => 3,
            Self::TwoSkeletons { .. } | Self::UnknownKind { .. } | Self::Video { .. } => 2,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::TwoSkeletons { .. } => "inspect the motions of each skeleton by themselves",
            Self::UnknownKind { .. } => {
                "give a calibration, a set-up, configuration, body or mapping (.toml), a folder of keypoints, masks or images, a motion file (.trc, .c3d, .bvh, .mot, .csv, .asf with .amc), a motion model or latent model (.json), a result folder or its posterior.zarr"
            }
            Self::Video { .. } => {
                "run a 2D pose detector over the videos first, and inspect the folder of keypoints that it fills"
            }
            Self::NoPoints { .. } | Self::OtherMotion { .. } => {
                "give the true points of the recording that was tracked (.trc, .bvh or .csv), at the same times"
            }
            Self::NoStore { .. } => {
                "give the folder `posterior.zarr` itself, not one inside it, and no store of format 2"
            }
        }
    }
}
