//! What can go wrong in a run, with the exit code and the advice that belong to it.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | failed for another reason: numerical failure, a bug |
//! | 2 | wrong usage or configuration |
//! | 3 | bad input data |
//! | 4 | finished and written, but a diagnostic failed |
//! | 5 | files and disk |
//! | 75 | interrupted; what was done is written and marked incomplete, `--resume` continues from there |
//! | 130 | second interrupt, nothing saved since |

use crate::results::error::{Occupied, ResultsError};
use crate::results::problem::Problem;
use crate::track::error::TrackError;
use sinew_recording::setup::SetupError;
use sinew_recording::{Error as RecordingError, FileError, Problems};
use std::io;
use std::path::{Path, PathBuf};

/// Everything that ends a run early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, body or set-up that cannot be used.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A recording that cannot be tracked as it stands.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A frame without a posterior.
    #[error(transparent)]
    Tracking(#[from] sinew_tracking::Error),
    /// A file or folder that cannot be read or written.
    #[error(transparent)]
    Io(#[from] FileError),
    /// Results that cannot be written or read back.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The output folder holds something.
    #[error("`{}` {}", path.display(), found.words())]
    OutputExists {
        /// Output folder.
        path: PathBuf,
        /// What is in it.
        found: Occupied,
    },
    /// The output folder is being written by another run.
    #[error("`{}` is in use by another run{}", path.display(), pid.map(|pid| format!(" (process {pid})")).unwrap_or_default())]
    OutputLocked {
        /// Output folder.
        path: PathBuf,
        /// Process that holds the lock.
        pid: Option<u32>,
    },
    /// A run that was stopped cannot be resumed.
    #[error("`{}` {problem}", folder.display())]
    Checkpoint {
        /// Output folder.
        folder: PathBuf,
        /// Why.
        problem: Box<Problem>,
    },
    /// The output folder holds or is an input.
    #[error("the output folder `{}` is also the input `{}`", path.display(), input.display())]
    OutputIsInput {
        /// Output folder.
        path: PathBuf,
        /// Input inside it.
        input: PathBuf,
    },
    /// A configuration with mistakes.
    #[error(transparent)]
    Config(#[from] Problems),
    /// The user requested an end where there was nothing new to write.
    #[error("interrupted {0}")]
    Interrupted(&'static str),
}

impl From<sinew_formats::Error> for Error {
    fn from(error: sinew_formats::Error) -> Self {
        Self::Recording(error.into())
    }
}

impl From<SetupError> for Error {
    fn from(error: SetupError) -> Self {
        Self::Recording(error.into())
    }
}

impl Error {
    /// An [`Error::Io`] in the making: `map_err(Error::io("read", path))`.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let on = FileError::on(doing, path);
        move |source| Self::Io(on(source))
    }

    /// The file that could not be read or written, if that is what went wrong.
    #[must_use]
    pub const fn file(&self) -> Option<&FileError> {
        match self {
            Self::Io(error) | Self::Recording(RecordingError::Io(error)) => Some(error),
            _ => None,
        }
    }

    /// An [`Error::Checkpoint`].
    pub fn checkpoint(folder: &Path, problem: Problem) -> Self {
        Self::Checkpoint { folder: folder.to_owned(), problem: Box::new(problem) }
    }

    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Checkpoint { problem, .. } => problem.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::Recording(error) => error.exit_code(),
            Self::Track(error) => error.exit_code(),
            Self::Tracking(_) => 1,
            Self::Interrupted(_) => 75,
            Self::Config(_) | Self::OutputIsInput { .. } => 2,
            Self::Io(_) | Self::OutputExists { .. } | Self::OutputLocked { .. } => 5,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Recording(error) => error.help(),
            Self::Io(error) => error.help(),
            Self::Results(error) => error.help(),
            Self::OutputExists { found, .. } => Some(found.help().into()),
            Self::Track(error) => error.help(),
            Self::OutputLocked { .. } => Some("wait for it to end, or choose another folder with `-o`".into()),
            Self::Checkpoint { problem, .. } => Some(problem.help().into()),
            Self::OutputIsInput { .. } => Some("choose another folder with `-o`".into()),
            Self::Config(_) => Some(Problems::HELP.into()),
            Self::Interrupted(_) | Self::Tracking(_) => None,
        }
    }
}
