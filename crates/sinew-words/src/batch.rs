//! Studies of many trials that cannot go on.

use crate::track;
use sinew_batch::Error;

/// What the user can do about an error of a study.
#[must_use]
pub fn help(error: &Error) -> Option<String> {
    let words = match error {
        Error::Run(error) => return track::help(error),
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
    };
    Some(words.to_owned())
}
