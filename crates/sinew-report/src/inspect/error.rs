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
