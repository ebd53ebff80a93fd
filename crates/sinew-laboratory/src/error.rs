//! What can go wrong, with the exit code and the advice that belong to it.

use crate::compare::CompareError;
use crate::opensim::OpensimError;

/// Everything that ends a comparison or an export early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A result, motion or file that cannot be used.
    #[error(transparent)]
    Tools(#[from] sinew_tools::Error),
    /// A result and a reference that cannot be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// A result that OpenSim cannot be given.
    #[error(transparent)]
    Opensim(#[from] OpensimError),
}

impl From<sinew::Error> for Error {
    fn from(error: sinew::Error) -> Self {
        Self::Tools(error.into())
    }
}

impl From<sinew::RecordingError> for Error {
    fn from(error: sinew::RecordingError) -> Self {
        Self::Tools(error.into())
    }
}

impl From<sinew::setup::SetupError> for Error {
    fn from(error: sinew::setup::SetupError) -> Self {
        Self::Tools(error.into())
    }
}

impl From<sinew_formats::Error> for Error {
    fn from(error: sinew_formats::Error) -> Self {
        Self::Tools(error.into())
    }
}

impl Error {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Tools(error) => error.exit_code(),
            Self::Compare(error) => error.exit_code(),
            Self::Opensim(error) => error.exit_code(),
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Tools(error) => error.help(),
            Self::Compare(error) => Some(error.help().into()),
            Self::Opensim(error) => Some(error.help().into()),
        }
    }
}
