//! What ends a command early: a mistake in how it was called, or what the library refuses.

use std::ops::Range;
use std::path::PathBuf;

/// Everything that ends a command early.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
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
    /// A flag of other commands.
    #[error("`{flag}` has no use here; it belongs to {}", owners.join(", "))]
    ForeignFlag {
        /// The flag, with its dashes.
        flag: String,
        /// The commands that take it, as typed.
        owners: Vec<String>,
    },
    /// A flag on how to read keypoints, and no keypoints.
    #[error("`--{flag}` is about reading keypoints, and no keypoint folder was given")]
    NoKeypointsToRead {
        /// The flag, without its dashes.
        flag: String,
    },
    /// Clocks that no keypoints or cameras are there to compare.
    #[error("no {0} given; clocks are compared by how keypoints move in calibrated cameras")]
    NothingToSynchronise(&'static str),
    /// A command that writes, and no place to write to.
    #[error("no {} was given", .0.words())]
    NoPlace(Written),
    /// A number that must be positive.
    #[error("`--{flag}` is {value}; it must be greater than 0")]
    NotPositive {
        /// The flag, without its dashes.
        flag: &'static str,
        /// Value given.
        value: f64,
        /// What to give.
        help: &'static str,
    },
    /// A validation without keypoints.
    #[error("no keypoints to hold a prediction against")]
    NothingToValidate,
    /// A validation with a set-up that may know the cameras that are left out.
    #[error("a set-up is given; what it learned from a camera that is left out would be no prediction")]
    SetupToValidate,
    /// A validation of cameras that are too few.
    #[error("{0} cameras; three are needed, so that two are left when one is left out")]
    TooFewToLeaveOut(usize),
    /// A picture of something other than one model or the actions of one run.
    #[error("only one motion model, latent model or `actions.csv` at a time can be drawn")]
    NothingToDraw,
    /// A file that would be written over while it is read.
    #[error("{} is both input and output", .0.display())]
    InputIsOutput(PathBuf),
    /// A file that the run itself writes.
    #[error("{} is a file that the run itself writes", .0.display())]
    ResultIsOutput(PathBuf),
    /// A frame rate for a calibration.
    #[error("a calibration has no frame rate")]
    RateOfCalibration,
    /// Names of bones for a calibration.
    #[error("a calibration has no bones")]
    BonesOfCalibration,
    /// A scale of a world that is not aligned.
    #[error("`--scale` is about a world that is aligned, and `--align` leaves it")]
    ScaleWithoutSpace,
    /// A skeleton for the walk, which has its own.
    #[error("the walk needs no skeleton")]
    SkeletonOfWalk,
    /// Several people who make a motion from a file.
    #[error("several people walk; a motion file is of one")]
    CrowdOfMotion,
    /// A simulation of more frames than anybody looks at.
    #[error("more than {0} frames")]
    TooManyFrames(usize),
    /// A simulation of no frame.
    #[error("no frame in that time")]
    NoFrames,
    /// A scene that cannot be simulated.
    #[error("{0}")]
    Scene(sinew_simulate::Error),
    /// The built-in recording cannot be made.
    #[error("{0}")]
    Demo(sinew::observe::Error),
}

/// What a command writes where `-o` says.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Written {
    /// Masks of `segment`.
    Masks,
    /// Pictures of `overlay`.
    Pictures,
    /// The body file of `fit-shape`.
    Body,
    /// The model of `learn`.
    Model,
    /// The table of `predict`.
    Prediction,
}

impl Written {
    const fn words(self) -> &'static str {
        match self {
            Self::Masks => "folder for the masks",
            Self::Pictures => "folder for the pictures",
            Self::Body => "body file to write",
            Self::Model => "model to write",
            Self::Prediction => "table to write",
        }
    }

    const fn example(self) -> &'static str {
        match self {
            Self::Masks => "masks",
            Self::Pictures => "pictures",
            Self::Body => "body.toml",
            Self::Model => "walk.json",
            Self::Prediction => "predicted.csv",
        }
    }
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
    /// Code with which the program ends; the table is that of [`sinew::Error`].
    pub(crate) const fn exit_code(&self) -> u8 {
        match self {
            Self::Library(error) => error.exit_code(),
            Self::Tools(error) => error.exit_code(),
            Self::Threads(_) | Self::Demo(_) => 1,
            Self::SetupFrames { .. } | Self::NoSuchPerson { .. } | Self::Scene(_) => 3,
            _ => 2,
        }
    }

    /// What the user can do about it.
    pub(crate) fn help(&self) -> Option<String> {
        let words = match self {
            Self::Library(error) => return error.help(),
            Self::Tools(error) => return error.help(),
            Self::Scene(error) => return error.help(),
            Self::NoPlace(written) => {
                return Some(format!("name one with `-o`, for example `-o {}`", written.example()));
            }
            Self::NotPositive { help, .. } => help,
            Self::Threads(_) | Self::Demo(_) => return None,
            Self::NothingToTrack { .. } => TRY,
            Self::SetupFrames { .. } => "`--setup-frames A..B` takes the numbers in the file names, A included, B not",
            Self::NoSuchPerson { .. } => {
                "`--person` counts from 1 in the order of coming; `sinew inspect` with calibration and keypoints says who is there"
            }
            Self::ForeignFlag { .. } => "leave it out, or put it after the command that it belongs to",
            Self::NoKeypointsToRead { .. } => "give the keypoint folder too, or leave the flag out",
            Self::NothingToSynchronise(_) => "try `--calibration Calib.toml --keypoints pose --fps 60`",
            Self::NothingToValidate => "give the keypoints of at least three cameras with `--keypoints`",
            Self::SetupToValidate => "leave `setup` out: each run makes its own from the cameras that it uses",
            Self::TooFewToLeaveOut(_) => "give more cameras, or judge the run by other means (`sinew predict`)",
            Self::InputIsOutput(_) | Self::ResultIsOutput(_) => "write to another file",
            Self::NothingToDraw => "give one file of `sinew learn` or of a run with `--method hppf`, or leave `-o` out",
            Self::RateOfCalibration => "`--fps` belongs to motion files; leave it out",
            Self::BonesOfCalibration => "`--bones` belongs to motion.bvh; leave it out",
            Self::ScaleWithoutSpace => "leave it out, or use `--align both` or `--align space`",
            Self::SkeletonOfWalk => "`--skeleton` belongs to .amc files; leave it out",
            Self::CrowdOfMotion => "leave `--motion` or `--people` out",
            Self::TooManyFrames(_) => "ask for less with `--duration` or `--fps`",
            Self::NoFrames => "ask for more with `--duration` or `--fps`",
        };
        Some(words.to_owned())
    }
}
