//! What can be wrong with a recording, with the exit code and the advice that belong to it.

use crate::bodies::error::UnknownBody;
use crate::file_error::FileError;
use crate::input::error::InputError;
use crate::problems::Problems;
use crate::setup::error::SetupError;
use std::io;
use std::path::PathBuf;

/// A recording, body or set-up that cannot be used. Exit codes: 2 usage, 3 input data, 5 files and disk.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that its reader refuses.
    #[error(transparent)]
    Format(#[from] sinew_formats::Error),
    /// A recording that cannot be read as it stands.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A recording that cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A name that is no body's.
    #[error(transparent)]
    Body(#[from] UnknownBody),
    /// A file or folder that cannot be read.
    #[error(transparent)]
    Io(#[from] FileError),
    /// A set-up file with mistakes.
    #[error(transparent)]
    Config(#[from] Problems),
}

impl From<sinew_dynamics::Error> for Error {
    fn from(error: sinew_dynamics::Error) -> Self {
        Self::Setup(error.into())
    }
}

impl Error {
    /// An [`Error::Io`] in the making: `map_err(Error::io("read", path))`.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let on = FileError::on(doing, path);
        move |source| Self::Io(on(source))
    }

    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Input(error) => error.exit_code(),
            Self::Setup(error) => error.exit_code(),
            Self::Body(error) => error.exit_code(),
            Self::Config(_) | Self::Format(sinew_formats::Error::UnknownLayout { .. }) => 2,
            Self::Format(_) => 3,
            Self::Io(_) => 5,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Format(error) => error.help(),
            Self::Input(error) => Some(error.help()),
            Self::Setup(error) => error.help(),
            Self::Body(error) => Some(error.help().into()),
            Self::Io(error) => error.help(),
            Self::Config(_) => Some(Problems::HELP.into()),
        }
    }
}
