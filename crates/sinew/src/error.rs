//! What can go wrong in a run.

use crate::predict::error::PredictError;
use crate::run::live::error::LiveError;
use crate::track::error::TrackError;
use sinew_input::{FileError, InputError, Problems};
use sinew_results::{ReadError, ResultsError};
use sinew_setup::SetupError;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

/// Everything that ends a run early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A recording, set-up or result folder that cannot be used.
    #[error(transparent)]
    Results(#[from] sinew_results::Error),
    /// A recording that cannot be tracked as it stands.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A frame without a posterior.
    #[error(transparent)]
    Tracking(#[from] sinew_tracking::Error),
    /// What a camera should see cannot be said.
    #[error(transparent)]
    Predict(#[from] PredictError),
    /// The user requested an end where there was nothing new to write.
    #[error("interrupted {0}")]
    Interrupted(String),
    /// Nothing to track with.
    #[error("{}", missing(*calibration, *observation))]
    NothingToTrack {
        /// Whether a calibration was given.
        calibration: bool,
        /// Whether keypoints or silhouettes were given.
        observation: bool,
    },
    /// Set-up frames that the recording does not have.
    #[error("set-up frames {}..{} were requested; the recording has {}..{}", asked.start, asked.end, available.start, available.end)]
    SetupFrames {
        /// Frames given.
        asked: Range<u64>,
        /// Frames of the recording.
        available: Range<u64>,
    },
    /// Fewer people than the chosen number.
    #[error("person {chosen} was chosen; two cameras see {found} for a quarter of a second or more", found = people(*found))]
    NoSuchPerson {
        /// Number given.
        chosen: usize,
        /// People there.
        found: usize,
    },
    /// What is refused of a live run.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// The system grants no threads.
    #[error("threads cannot be started: {0}")]
    Threads(rayon::ThreadPoolBuildError),
    /// A file that would be written over while it is read.
    #[error("{} is both input and output", .0.display())]
    InputIsOutput(PathBuf),
    /// A file that the run itself writes.
    #[error("{} is a file that the run itself writes", .0.display())]
    ResultIsOutput(PathBuf),
}

sinew_input::errors_from_below!(
    Error::Results: sinew_setup::Error, sinew_input::Error, sinew_formats::Error, FileError, InputError, Problems, SetupError, ResultsError,
    ReadError
);

fn people(count: usize) -> String {
    if count == 1 { "one person".into() } else { format!("{count} people") }
}

const fn missing(calibration: bool, observation: bool) -> &'static str {
    match (calibration, observation) {
        (false, false) => "neither calibration nor keypoints were given",
        (false, true) => "no calibration was given",
        (true, _) => "no keypoints were given",
    }
}

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
            Self::Results(error) => error.file(),
            _ => None,
        }
    }
}

/// An error and what caused it, in one line.
#[must_use]
pub fn with_causes(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}
