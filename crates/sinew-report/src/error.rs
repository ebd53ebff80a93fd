//! What can go wrong where results are shown.

use crate::inspect::error::InspectError;
use crate::overlay::error::OverlayError;
use sinew_input::{FileError, InputError};
use sinew_motion::learn::LearnError;
use sinew_results::{ReadError, ResultsError};
use sinew_setup::SetupError;

/// Everything that ends a page, a picture or an inspection early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, result or file that cannot be used.
    #[error(transparent)]
    Analysis(#[from] sinew_analysis::Error),
    /// Paths that cannot be inspected.
    #[error(transparent)]
    Inspect(#[from] InspectError),
    /// Pictures that cannot be drawn.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
}

impl From<LearnError> for Error {
    fn from(error: LearnError) -> Self {
        sinew_motion::Error::from(error).into()
    }
}

sinew_input::errors_from_below!(
    Error::Analysis: sinew::Error, sinew_motion::Error, sinew_results::Error, sinew_setup::Error, sinew_input::Error, sinew_formats::Error, FileError, InputError, SetupError, ReadError, ResultsError
);
