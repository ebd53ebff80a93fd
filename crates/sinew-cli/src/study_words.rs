//! What is said of studies of many trials that cannot go on: advice and exit codes.

use sinew_batch::Error;
use sinew_words::exit_codes::{FAILED, FILES, INPUT, USAGE, run};

/// What the user can do about an error of a study.
pub(crate) fn help(error: &Error) -> Option<String> {
    let words = match error {
        Error::Run(error) => return sinew_words::help_with_run(error),
        Error::NoTrials(_) => {
            "give each trial a `sinew.toml` with `keypoints = \"pose\"`; what all share stands in one above them"
        }
        Error::NotAStudy(_) => "make one with `sinew batch plan TRIALS -o STUDY`",
        Error::StudyFile { .. } => {
            "make the plan again with `sinew batch plan TRIALS -o STUDY --force`; what is done stays done"
        }
        Error::ShardInUse { .. } => "wait for it, or run another shard",
        Error::NotPacked { .. } => {
            "summary.csv of `sinew batch gather` has the names; results that are not packed lie in results/"
        }
        Error::UnlikeTrials { .. } => {
            "give `subject` only to trials with the same cameras and keypoints, or different names"
        }
        _ => return None,
    };
    Some(words.to_owned())
}

/// The code for an error of a study.
pub(crate) const fn exit_code(error: &Error) -> u8 {
    match error {
        Error::Run(error) => run(error),
        Error::UnlikeTrials { .. } | Error::NoTrials(_) | Error::NotPacked { .. } => INPUT,
        Error::ShardInUse { .. } => FILES,
        Error::NotAStudy(_) | Error::StudyFile { .. } => USAGE,
        _ => FAILED,
    }
}
