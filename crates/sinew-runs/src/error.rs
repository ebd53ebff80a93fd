//! What can go wrong in a whole run, with the exit code and the advice that belong to it.

use std::ops::Range;
use std::path::PathBuf;

/// Everything that ends a run early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What the library refuses.
    #[error(transparent)]
    Library(#[from] sinew::Error),
    /// What the tools beside a run refuse.
    #[error(transparent)]
    Tools(#[from] sinew_tools::Error),
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

/// Commands to try where there was nothing to track with.
const TRY: &str = "try one of
  sinew track --calibration Calib.toml --keypoints pose --fps 60
  sinew track --calibration Calib.toml --silhouettes masks --keypoints pose --method annealed --fps 60
  sinew demo";

impl From<sinew::RecordingError> for Error {
    fn from(error: sinew::RecordingError) -> Self {
        Self::Library(error.into())
    }
}

impl Error {
    /// Code with which a program ends; the table is that of [`sinew::Error`].
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Library(error) => error.exit_code(),
            Self::Tools(error) => error.exit_code(),
            Self::Threads(_) => 1,
            Self::SetupFrames { .. } | Self::NoSuchPerson { .. } => 3,
            Self::NothingToTrack { .. } | Self::InputIsOutput(_) | Self::ResultIsOutput(_) => 2,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        let words = match self {
            Self::Library(error) => return error.help(),
            Self::Tools(error) => return error.help(),
            Self::Threads(_) => return None,
            Self::NothingToTrack { .. } => TRY,
            Self::SetupFrames { .. } => "`--setup-frames A..B` takes the numbers in the file names, A included, B not",
            Self::NoSuchPerson { .. } => {
                "`--person` counts from 1 in the order of coming; `sinew inspect` with calibration and keypoints says who is there"
            }
            Self::InputIsOutput(_) | Self::ResultIsOutput(_) => "write to another file",
        };
        Some(words.to_owned())
    }
}
