//! What can go wrong where results are analysed.

use crate::compare::error::CompareError;
use crate::gait::error::GaitError;
use crate::opensim::error::OpensimError;
use crate::segment::error::SegmentError;
use crate::shape_fit::error::ShapeFitError;
use crate::sync::error::SyncError;
use sinew_input::{FileError, InputError};
use sinew_motion::convert::MotionError;
use sinew_results::{ReadError, ResultsError};
use sinew_setup::SetupError;

/// Everything that ends an analysis early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, result or prediction that cannot be used.
    #[error(transparent)]
    Run(#[from] sinew::Error),
    /// A motion that cannot be read.
    #[error(transparent)]
    Motion(#[from] sinew_motion::Error),
    /// A result and a reference that cannot be compared.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// Results that no gait can be read from.
    #[error(transparent)]
    Gait(#[from] GaitError),
    /// A result that OpenSim cannot be given.
    #[error(transparent)]
    Opensim(#[from] OpensimError),
    /// Images from which no masks can be made.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// Masks or solids that cannot be compared.
    #[error(transparent)]
    ShapeFit(#[from] ShapeFitError),
    /// Cameras that have no clocks to compare.
    #[error(transparent)]
    Sync(#[from] SyncError),
}

sinew_input::errors_from_below!(
    Error::Run: sinew_results::Error, sinew_setup::Error, sinew_input::Error, sinew_formats::Error, FileError, InputError, SetupError, ReadError, ResultsError
);
sinew_input::errors_from_below!(Error::Motion: MotionError);
