//! What can be wrong with recorded motion, with the exit code and the advice that belong to it.

use crate::convert::error::MotionError;
use crate::learn::error::LearnError;
use sinew_input::FileError;
use sinew_results::ResultsError;

/// Motion that cannot be read, converted or learned from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that cannot be read or written.
    #[error(transparent)]
    Results(#[from] sinew_results::Error),
    /// A motion that cannot be read or converted.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Motion from which nothing can be learned.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

sinew_input::errors_from_below!(Error::Results: sinew_setup::Error, sinew_input::Error, sinew_formats::Error, FileError, ResultsError);

impl Error {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Results(error) => error.exit_code(),
            Self::Motion(error) => error.exit_code(),
            Self::Learn(error) => error.exit_code(),
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Results(error) => error.help(),
            Self::Motion(error) => error.help(),
            Self::Learn(error) => error.help(),
        }
    }
}
