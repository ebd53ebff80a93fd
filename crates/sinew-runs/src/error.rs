//! What can go wrong in a whole run, with the exit code and the advice that belong to it.

use super::live::LiveError;
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
    /// What is refused of a live run.
    #[error(transparent)]
    Live(#[from] LiveError),
    /// The system grants no threads.
    #[error("threads cannot be started: {0}")]
    Threads(rayon::ThreadPoolBuildError),
    /// A folder without trials.
    #[error("{} holds no trial: no `sinew.toml` that names keypoints or silhouettes, and no folder `pose` with keypoints", .0.display())]
    NoTrials(PathBuf),
    /// A folder that is no study.
    #[error("{} is not a study: it has no `plan.json` and `tasks.jsonl`", .0.display())]
    NotAStudy(PathBuf),
    /// A file of a study that was changed.
    #[error("{}, line {line}: {problem}", path.display())]
    StudyFile {
        /// The file.
        path: PathBuf,
        /// Line in it.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A shard that another process runs.
    #[error("shard {shard} of {} is being run by another process", study.display())]
    ShardInUse {
        /// Which.
        shard: String,
        /// Folder of the study.
        study: PathBuf,
    },
    /// A trial without packed results.
    #[error("{} has no packed results of `{trial}`", study.display())]
    NotPacked {
        /// Folder of the study.
        study: PathBuf,
        /// Name given.
        trial: String,
    },
    /// Trials that cannot share a set-up.
    #[error("the trials of `{pool}` have different cameras or keypoints and cannot share a set-up")]
    UnlikeTrials {
        /// Name of the pool.
        pool: String,
    },
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
            Self::Live(error) => error.exit_code(),
            Self::Threads(_) => 1,
            Self::SetupFrames { .. }
            | Self::NoSuchPerson { .. }
            | Self::UnlikeTrials { .. }
            | Self::NoTrials(_)
            | Self::NotPacked { .. } => 3,
            Self::ShardInUse { .. } => 5,
            Self::NothingToTrack { .. }
            | Self::NotAStudy(_)
            | Self::StudyFile { .. }
            | Self::InputIsOutput(_)
            | Self::ResultIsOutput(_) => 2,
        }
    }

    /// It and what caused it, in one line.
    pub(crate) fn with_causes(&self) -> String {
        let causes = std::iter::successors(std::error::Error::source(self), |cause| cause.source());
        causes.fold(self.to_string(), |text, cause| format!("{text}: {cause}"))
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        let words = match self {
            Self::Library(error) => return error.help(),
            Self::Tools(error) => return error.help(),
            Self::Live(error) => error.help(),
            Self::Threads(_) => return None,
            Self::NothingToTrack { .. } => TRY,
            Self::SetupFrames { .. } => "`--setup-frames A..B` takes the numbers in the file names, A included, B not",
            Self::NoSuchPerson { .. } => {
                "`--person` counts from 1 in the order of coming; `sinew inspect` with calibration and keypoints says who is there"
            }
            Self::InputIsOutput(_) | Self::ResultIsOutput(_) => "write to another file",
            Self::NoTrials(_) => {
                "give each trial a `sinew.toml` with `keypoints = \"pose\"`; what all share stands in one above them"
            }
            Self::NotAStudy(_) => "make one with `sinew batch plan TRIALS -o STUDY`",
            Self::StudyFile { .. } => {
                "make the plan again with `sinew batch plan TRIALS -o STUDY --force`; what is done stays done"
            }
            Self::ShardInUse { .. } => "wait for it, or run another shard",
            Self::NotPacked { .. } => {
                "summary.csv of `sinew batch gather` has the names; results that are not packed lie in results/"
            }
            Self::UnlikeTrials { .. } => {
                "give `subject` only to trials with the same cameras and keypoints, or different names"
            }
        };
        Some(words.to_owned())
    }
}
