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

impl ReadError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Running(_) => 5,
            _ => 3,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::NoSummary(_) => "give the folder that `sinew track` wrote, `sinew-out/<trial>` or what `-o` said",
            Self::Stopped(_) => {
                "continue with the same command and `--resume`; an interrupt with Ctrl-C writes its files"
            }
            Self::Running(_) => "wait for its end",
            Self::NoFile { .. } | Self::OtherRun(_) => "track again, or take the folder as the run left it",
            Self::NoFrames(_) => "track again, or continue with `--resume`",
        }
    }
}
