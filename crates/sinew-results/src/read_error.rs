//! Why a folder holds no whole results.

use std::path::PathBuf;

/// A folder that does not hold whole results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// A folder without the summary of a run.
    #[error("{}: no results: summary.json is missing", .0.display())]
    NoSummary(PathBuf),
    /// A folder without the summary, of a run that was stopped.
    #[error("{}: a run was stopped here before its files were whole", .0.display())]
    Stopped(PathBuf),
    /// A folder in which a run is writing.
    #[error("{}: a run is writing into it", .0.display())]
    Running(PathBuf),
    /// A file of the results is missing.
    #[error("{}: {file} is missing", folder.display())]
    NoFile {
        /// Result folder.
        folder: PathBuf,
        /// The file.
        file: &'static str,
    },
    /// Results of no frame.
    #[error("{}: the results have no frame", .0.display())]
    NoFrames(PathBuf),
    /// Files of different runs.
    #[error("{} and frames.csv are of different runs", .0.display())]
    OtherRun(PathBuf),
}
