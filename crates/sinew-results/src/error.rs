//! What can be wrong with a result folder.

use crate::problem::Problem;
use crate::read_error::ReadError;
use crate::results_error::{Occupied, ResultsError};
use sinew_input::{FileError, InputError, Problems};
use sinew_setup::SetupError;
use std::io;
use std::path::{Path, PathBuf};

/// A result folder, or what it was made from, that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, body or set-up that cannot be used.
    #[error(transparent)]
    Setup(#[from] sinew_setup::Error),
    /// Results that cannot be written or read back.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// A folder that does not hold whole results.
    #[error(transparent)]
    Read(#[from] ReadError),
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
    /// A name of a file to be written that leads out of the output folder.
    #[error("`{}` leads out of the output folder `{}`", name.display(), folder.display())]
    OutputOutside {
        /// Output folder.
        folder: PathBuf,
        /// Name of the file, or of a folder on its way.
        name: PathBuf,
    },
    /// A link where a file or a folder of results is to be.
    #[error("`{}` is a link, and files are written only below the output folder", .0.display())]
    OutputLink(PathBuf),
    /// The output folder holds or is an input.
    #[error("the output folder `{}` is also the input `{}`", path.display(), input.display())]
    OutputIsInput {
        /// Output folder.
        path: PathBuf,
        /// Input inside it.
        input: PathBuf,
    },
}

sinew_input::errors_from_below!(Error::Setup: sinew_input::Error, sinew_formats::Error, FileError, InputError, Problems, SetupError);

impl Error {
    /// A [`FileError`] in the making: `map_err(Error::io("read", path))`.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let on = FileError::on(doing, path);
        move |source| on(source).into()
    }

    /// The file that could not be read or written, if that is what went wrong.
    #[must_use]
    pub const fn file(&self) -> Option<&FileError> {
        match self {
            Self::Setup(sinew_setup::Error::Input(sinew_input::Error::Io(error))) => Some(error),
            _ => None,
        }
    }

    /// An [`Error::Checkpoint`].
    pub fn checkpoint(folder: &Path, problem: Problem) -> Self {
        Self::Checkpoint { folder: folder.to_owned(), problem: Box::new(problem) }
    }
}
