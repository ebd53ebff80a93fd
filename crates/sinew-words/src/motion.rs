//! Motion that cannot be read, converted or learned from.

use crate::{models, results};
use sinew_motion::convert::MotionError;
use sinew_motion::learn::LearnError;
use sinew_motion::{Error, FollowError};

/// What a motion file must have.
const NEEDED: &str = "needed are the positions of neck, head, shoulders, elbows, wrists, hips, knees and ankles, as in BVH files or in `truth.trc` of `sinew demo`";

pub(crate) fn help(error: &Error) -> Option<String> {
    match error {
        Error::Results(error) => results::help(error),
        Error::Motion(error) => conversion(error),
        Error::Learn(error) => learning(error),
        _ => None,
    }
}

fn conversion(error: &MotionError) -> Option<String> {
    let fixed = match error {
        MotionError::UnknownExtension { .. } => {
            "known: .trc, .c3d, .bvh, .mot, .csv, .amc to read and .glb to write; calibrations are written as .toml, .yml and .qca.txt"
        }
        MotionError::NeedlessSkeleton { .. } => "`--skeleton` belongs to .amc files; leave it out",
        MotionError::NoSkeleton { .. } => "give its skeleton with `--skeleton FILE.asf`",
        MotionError::NoMotion { motions, .. } => return Some(format!("convert {motions}")),
        MotionError::NoTimes { .. } => "name the column of the times `time_s`, in seconds",
        MotionError::OtherBones { .. } => "give motion.bvh of a result folder",
        MotionError::ReadOnly => "write .bvh instead",
        MotionError::WriteOnly { .. } => "give motion.bvh of the same result folder",
        MotionError::Impossible { instead, .. } => instead,
        MotionError::NoPoints { .. } => NEEDED,
        MotionError::Joints { problem, .. } => return following(problem),
        MotionError::NoColumns { .. } | MotionError::Unwritable { .. } | _ => return None,
    };
    Some(fixed.into())
}

fn learning(error: &LearnError) -> Option<String> {
    match error {
        LearnError::NoSkeleton { .. } => Some("give the skeleton with `--skeleton FILE.asf`".into()),
        LearnError::Follow { problem, .. } => following(problem).or_else(|| Some("leave the file out".into())),
        LearnError::OtherUnits { .. } => Some("check the units of the file and numbers that are out of place".into()),
        LearnError::TooShort { .. } => Some("leave the file out, or learn at a higher rate with `--fps`".into()),
        LearnError::Learning(_) => {
            Some("give more motion, fewer clusters (`--clusters`) or shorter primitives (`--length`)".into())
        }
        LearnError::NoWindows { .. } => Some("give longer recordings, or a shorter `--length`".into()),
        LearnError::Unwritable(_) => Some("give more motion, or fewer clusters (`--clusters`)".into()),
        LearnError::Model(error) => models::help(error),
        LearnError::ShortSequence { .. } => Some("leave the file out, or learn at a higher rate with `--fps`".into()),
        LearnError::TooManySequences { .. } => Some("give fewer files, or allow more rows with `--rows`".into()),
        LearnError::FewComponents { .. } => Some("give more motion, or fewer coordinates with `--dim`".into()),
        LearnError::StillLimb { .. } => Some("give motion of the whole body, or learn `--model gpdm`".into()),
        LearnError::Latent(_) | LearnError::UnwritableLatent(_) => {
            Some("give more motion, or fewer coordinates with `--dim`".into())
        }
        LearnError::LatentModel(error) => models::help(error),
        _ => None,
    }
}

fn following(error: &FollowError) -> Option<String> {
    match error {
        FollowError::UnknownJoints(_) | FollowError::Gap { .. } | FollowError::SingleFrame | FollowError::Unit => {
            Some(NEEDED.into())
        }
        FollowError::NoPose => Some("leave the file out, or cut off its beginning".into()),
        FollowError::Body(_) | FollowError::NoFrames | _ => None,
    }
}
