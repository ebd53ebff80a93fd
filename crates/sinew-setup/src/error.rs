//! What can be wrong with a body or a set-up.

use crate::bodies::error::UnknownBody;
use crate::setup_error::SetupError;
use sinew_input::{FileError, InputError, Problems};

/// A recording, body or set-up that cannot be used.
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
