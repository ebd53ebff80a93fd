//! What ends a command early: a mistake in how it was called, or what the library refuses.

use crate::study_words;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew_words::exit_codes::{FAILED, INPUT, USAGE, exit_code};

/// Everything that ends a command early.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// What an analysis, a page or a picture refuses, and what ends a run early.
    #[error(transparent)]
    Report(#[from] sinew_report::Error),
    /// What a study of many trials refuses.
    #[error(transparent)]
    Batch(#[from] sinew_batch::Error),
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
    /// A part of a study that the environment does not say.
    #[error("no part of the study: {0}")]
    Shard(String),
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
    /// The study of `batch plan`.
    Study,
    /// The results of `batch unpack`.
    Trial,
}

impl Written {
    const fn words(self) -> &'static str {
        match self {
            Self::Masks => "folder for the masks",
            Self::Pictures => "folder for the pictures",
            Self::Body => "body file to write",
            Self::Model => "model to write",
            Self::Prediction => "table to write",
            Self::Study => "folder for the study",
            Self::Trial => "folder for the results",
        }
    }

    const fn example(self) -> &'static str {
        match self {
            Self::Masks => "masks",
            Self::Pictures => "pictures",
            Self::Body => "body.toml",
            Self::Model => "walk.json",
            Self::Prediction => "predicted.csv",
            Self::Study => "study",
            Self::Trial => "walk",
        }
    }
}

sinew_input::errors_from_below!(
    Error::Report: sinew_analysis::Error, sinew_motion::Error, sinew::Error, sinew_results::Error, sinew_setup::Error, sinew_input::Error
);

impl Error {
    /// Code with which the program ends; the table is that of [`sinew_words::exit_codes`].
    pub(crate) const fn exit_code(&self) -> u8 {
        match self {
            Self::Report(error) => exit_code(error),
            Self::Batch(error) => study_words::exit_code(error),
            Self::Demo(_) => FAILED,
            Self::Scene(_) => INPUT,
            _ => USAGE,
        }
    }

    /// What the user can do about it.
    pub(crate) fn help(&self) -> Option<String> {
        let words = match self {
            Self::Report(error) => return sinew_words::help(error),
            Self::Batch(error) => return study_words::help(error),
            Self::Scene(sinew_simulate::Error::MissingJoints(_)) => {
                return Some(format!("a body needs the points {}", EVALUATION_JOINTS.join(", ")));
            }
            Self::NoPlace(written) => {
                return Some(format!("name one with `-o`, for example `-o {}`", written.example()));
            }
            Self::NotPositive { help, .. } => help,
            Self::Scene(_) | Self::Demo(_) => return None,
            Self::ForeignFlag { .. } => "leave it out, or put it after the command that it belongs to",
            Self::NoKeypointsToRead { .. } => "give the keypoint folder too, or leave the flag out",
            Self::NothingToSynchronise(_) => "try `--calibration Calib.toml --keypoints pose --fps 60`",
            Self::Shard(_) => "name it with `--shard I/N`, or give the number of parts with `--shards N`",
            Self::NothingToValidate => "give the keypoints of at least three cameras with `--keypoints`",
            Self::SetupToValidate => "leave `setup` out: each run makes its own from the cameras that it uses",
            Self::TooFewToLeaveOut(_) => "give more cameras, or judge the run by other means (`sinew predict`)",
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
