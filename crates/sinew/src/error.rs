//! What can go wrong in a run, with the exit code and the advice that belong to it.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | failed for another reason: numerical failure, a bug |
//! | 2 | wrong usage or configuration |
//! | 3 | bad input data |
//! | 4 | finished and written, but a diagnostic failed |
//! | 5 | files and disk |
//! | 75 | interrupted; what was done is written and marked incomplete, `--resume` goes on from there |
//! | 130 | second interrupt, nothing saved since |

use crate::bodies::error::UnknownBody;
use crate::input::error::InputError;
use crate::input::missing_path;
use crate::inspect::error::InspectError;
use crate::motion::error::MotionError;
use crate::overlay::error::OverlayError;
use crate::results::error::{Occupied, ResultsError};
use crate::results::problem::Problem;
use crate::segment::error::SegmentError;
use crate::setup::error::SetupError;
use crate::shape_fit::error::ShapeFitError;
use crate::track::error::TrackError;
use std::io;
use std::path::{Path, PathBuf};

/// Everything that ends a run early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that its reader refuses.
    #[error(transparent)]
    Format(#[from] sinew_formats::Error),
    /// A recording that cannot be read as it stands.
    #[error(transparent)]
    Recording(#[from] InputError),
    /// A recording that cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A name that is no body's.
    #[error(transparent)]
    Body(#[from] UnknownBody),
    /// Paths that cannot be inspected.
    #[error(transparent)]
    Inspect(#[from] InspectError),
    /// A motion that cannot be read or converted.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// Pictures that cannot be drawn.
    #[error(transparent)]
    Overlay(#[from] OverlayError),
    /// Images from which no masks can be made.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// Masks or solids that cannot be compared.
    #[error(transparent)]
    ShapeFit(#[from] ShapeFitError),
    /// A recording that cannot be tracked as it stands.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A frame without a posterior.
    #[error(transparent)]
    Tracking(#[from] sinew_tracking::Error),
    /// A file or folder that cannot be read or written.
    #[error("cannot {doing} `{}`", path.display())]
    Io {
        /// Verb of the sentence.
        doing: &'static str,
        /// File or folder.
        path: PathBuf,
        /// What the system says.
        #[source]
        source: io::Error,
    },
    /// Results that cannot be written or read back.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The output folder holds something.
    #[error("`{}` {}", path.display(), found.words())]
    OutputExists {
        /// Output folder.
        path: PathBuf,
        /// What is in it.
        found: Occupied,
    },
    /// The output folder is being written by another run.
    #[error("`{}` is in use by another run{}", path.display(), pid.map(|pid| format!(" (process {pid})")).unwrap_or_default())]
    OutputLocked {
        /// Output folder.
        path: PathBuf,
        /// Process that holds the lock.
        pid: Option<u32>,
    },
    /// A run that was stopped cannot go on.
    #[error("`{}` {problem}", folder.display())]
    Checkpoint {
        /// Output folder.
        folder: PathBuf,
        /// Why.
        problem: Box<Problem>,
    },
    /// The output folder holds or is an input.
    #[error("the output folder `{}` is also the input `{}`", path.display(), input.display())]
    OutputIsInput {
        /// Output folder.
        path: PathBuf,
        /// Input inside it.
        input: PathBuf,
    },
    /// A configuration with mistakes, all of them.
    #[error("{}", crate::error::listed(file, problems))]
    Config {
        /// File, or `the command line`.
        file: String,
        /// What is wrong, one sentence each.
        problems: Vec<String>,
    },
    /// A request that cannot be carried out as it stands.
    #[error("{message}")]
    Usage {
        /// What is wrong.
        message: String,
        /// What to do.
        help: String,
    },
    /// Input data that cannot be used.
    #[error("{message}")]
    Input {
        /// What was found and what was expected.
        message: String,
        /// What to do.
        help: Option<String>,
    },
    /// The user asked for an end where there was nothing new to write.
    #[error("interrupted {0}")]
    Interrupted(&'static str),
    /// A computation that failed.
    #[error("{message}")]
    Numerical {
        /// What failed, with the frame.
        message: String,
    },
}

fn listed(file: &str, problems: &[String]) -> String {
    match problems {
        [one] => match one.strip_prefix("line ") {
            Some(rest) => format!("{file}:{rest}"),
            None => format!("{file}: {one}"),
        },
        many => format!("{} problems in {file}:\n  {}", many.len(), many.join("\n  ")),
    }
}

impl Error {
    /// An [`Error::Io`] in the making: `map_err(Error::io("read", path))`.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { doing, path, source }
    }

    /// An [`Error::Checkpoint`].
    pub fn checkpoint(folder: &Path, problem: Problem) -> Self {
        Self::Checkpoint { folder: folder.to_owned(), problem: Box::new(problem) }
    }

    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Checkpoint { problem, .. } => problem.exit_code(),
            Self::Results(error) => error.exit_code(),
            Self::Recording(error) => error.exit_code(),
            Self::Setup(error) => error.exit_code(),
            Self::Inspect(error) => error.exit_code(),
            Self::Motion(error) => error.exit_code(),
            Self::Overlay(error) => error.exit_code(),
            Self::Segment(error) => error.exit_code(),
            Self::ShapeFit(error) => error.exit_code(),
            Self::Body(error) => error.exit_code(),
            Self::Track(error) => error.exit_code(),
            Self::Numerical { .. } | Self::Tracking(_) => 1,
            Self::Interrupted(_) => 75,
            Self::Config { .. } | Self::Usage { .. } | Self::OutputIsInput { .. } => 2,
            Self::Format(sinew_formats::Error::UnknownLayout { .. }) => 2,
            Self::Format(_) | Self::Input { .. } => 3,
            Self::Io { .. } | Self::OutputExists { .. } | Self::OutputLocked { .. } => 5,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Format(error) => error.help(),
            Self::Results(error) => error.help().map(Into::into),
            Self::OutputExists { found, .. } => Some(found.help().into()),
            Self::Recording(error) => Some(error.help()),
            Self::Setup(error) => error.help(),
            Self::Body(error) => Some(error.help().into()),
            Self::Inspect(error) => Some(error.help().into()),
            Self::Motion(error) => error.help(),
            Self::Overlay(error) => error.help().map(Into::into),
            Self::Segment(error) => Some(error.help().into()),
            Self::ShapeFit(error) => error.help().map(Into::into),
            Self::Track(error) => error.help().map(Into::into),
            Self::OutputLocked { .. } => Some("wait for it to end, or choose another folder with `-o`".into()),
            Self::Checkpoint { problem, .. } => Some(problem.help().into()),
            Self::OutputIsInput { .. } => Some("choose another folder with `-o`".into()),
            Self::Usage { help, .. } => Some(help.clone()),
            Self::Input { help, .. } => help.clone(),
            Self::Config { .. } => {
                Some("`sinew track --help` lists the settings; `--print-config` shows the values in force".into())
            }
            Self::Io { path, source, .. } if source.kind() == io::ErrorKind::NotFound => missing_path::advice(path),
            Self::Io { .. } | Self::Interrupted(_) | Self::Numerical { .. } | Self::Tracking(_) => None,
        }
    }
}
