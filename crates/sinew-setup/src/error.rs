//! What can be wrong with a body or a set-up, with the exit code and the advice that belong to it.

use crate::bodies::error::UnknownBody;
use crate::setup_error::SetupError;
use sinew_input::{FileError, InputError, Problems};

/// A recording, body or set-up that cannot be used. Exit codes: 2 usage, 3 input data, 5 files and disk.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording or file that cannot be used.
    #[error(transparent)]
    Input(#[from] sinew_input::Error),
    /// A recording that cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A name that is no body's.
    #[error(transparent)]
    Body(#[from] UnknownBody),
}

sinew_input::errors_from_below!(Error::Input: sinew_formats::Error, FileError, InputError, Problems);
sinew_input::errors_from_below!(Error::Setup: sinew_dynamics::Error);

impl Error {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Input(error) => error.exit_code(),
            Self::Setup(error) => error.exit_code(),
            Self::Body(error) => error.exit_code(),
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Input(error) => error.help(),
            Self::Setup(error) => error.help(),
            Self::Body(error) => Some(error.help().into()),
        }
    }
}
