//! What can go wrong beside a run, with the exit code and the advice that belong to it.

use crate::gait::GaitError;
use crate::inspect::error::InspectError;
use crate::learn::LearnError;
use crate::motion::error::MotionError;
use crate::overlay::error::OverlayError;
use crate::predict::error::PredictError;
use crate::report::ReportError;
use crate::segment::error::SegmentError;
use crate::shape_fit::error::ShapeFitError;
use crate::sync::error::SyncError;
use sinew::input::InputError;
use sinew::setup::SetupError;

/// Everything that ends a tool early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, result or file that cannot be used.
    #[error(transparent)]
    Library(#[from] sinew::Error),
    /// Paths that cannot be inspected.
    #[error(transparent)]
    Inspect(#[from] InspectError),
    /// A motion that cannot be read or converted.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Pictures that cannot be drawn.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// What a camera should see cannot be said.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// Results that no gait can be read from.
    #[error(transparent)]
    Gait(#[from] GaitError),
    /// Results that no page can be made of.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Images from which no masks can be made.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// Masks or solids that cannot be compared.
    #[error(transparent)]
    ShapeFit(#[from] ShapeFitError),
    /// Cameras that have no clocks to compare.
    #[error(transparent)]
    Sync(#[from] SyncError),
    /// Motion from which nothing can be learned.
    #[error(transparent)]
    Learn(#[from] LearnError),
}

impl From<sinew::RecordingError> for Error {
    fn from(error: sinew::RecordingError) -> Self {
        Self::Library(error.into())
    }
}

impl From<InputError> for Error {
    fn from(error: InputError) -> Self {
        Self::Library(sinew::RecordingError::from(error).into())
    }
}

impl From<SetupError> for Error {
    fn from(error: SetupError) -> Self {
        Self::Library(error.into())
    }
}

impl From<sinew_formats::Error> for Error {
    fn from(error: sinew_formats::Error) -> Self {
        Self::Library(error.into())
    }
}

impl Error {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Library(error) => error.exit_code(),
            Self::Inspect(error) => error.exit_code(),
            Self::Motion(error) => error.exit_code(),
            Self::Overlay(error) => error.exit_code(),
            Self::Predict(error) => error.exit_code(),
            Self::Gait(error) => error.exit_code(),
            Self::Report(error) => error.exit_code(),
            Self::Segment(error) => error.exit_code(),
            Self::ShapeFit(error) => error.exit_code(),
            Self::Sync(error) => error.exit_code(),
            Self::Learn(error) => error.exit_code(),
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Library(error) => error.help(),
            Self::Inspect(error) => Some(error.help().into()),
            Self::Motion(error) => error.help(),
            Self::Overlay(error) => error.help().map(Into::into),
            Self::Predict(error) => error.help(),
            Self::Gait(error) => Some(error.help()),
            Self::Report(error) => Some(error.help().into()),
            Self::Segment(error) => Some(error.help().into()),
            Self::ShapeFit(error) => error.help().map(Into::into),
            Self::Sync(error) => Some(error.help().into()),
            Self::Learn(error) => error.help(),
        }
    }
}
