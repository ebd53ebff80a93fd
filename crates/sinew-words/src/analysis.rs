//! What cannot be analysed.

use crate::{motion, track};
use sinew_analysis::Error;
use sinew_analysis::compare::CompareError;
use sinew_analysis::gait::GaitError;
use sinew_analysis::opensim::OpensimError;
use sinew_analysis::segment::SegmentError;
use sinew_analysis::shape_fit::ShapeFitError;
use sinew_analysis::sync::error::SyncError;

pub(crate) fn help(error: &Error) -> Option<String> {
    let words = match error {
        Error::Run(error) => return track::help(error),
        Error::Motion(error) => return motion::help(error),
        Error::Compare(error) => comparison(error)?,
        Error::Gait(error) => gait(error)?,
        Error::Opensim(error) => opensim(error)?,
        Error::Segment(error) => masks(error)?,
        Error::ShapeFit(error) => thickness(error)?,
        Error::Sync(SyncError::OneCamera) => "give keypoints of two cameras or more",
        _ => return None,
    };
    Some(words.to_owned())
}

const fn comparison(error: &CompareError) -> Option<&'static str> {
    Some(match error {
        CompareError::NoSuchName { .. } => {
            "a line of the mapping is `ours = \"theirs\"`, or `ours = [\"one\", \"another\"]` for their middle; \
             `sinew inspect FILE` lists names"
        }
        CompareError::TooFewNames { .. } => {
            "write a mapping and give it with `--names`: [points] RKnee = [\"RKNE\", \"RKNM\"]"
        }
        CompareError::TooFewFrames { .. } => {
            "check that it is of the same trial; `--align both` searches all offsets at which half of the shorter \
             recording overlaps"
        }
        CompareError::OnALine(_) => "name more points, or use `--align time` where both share a world",
        CompareError::Times(_) => "write the file again with rising times",
        CompareError::SpaceOfAngles(_) => "use `--align time` or `--align none`, without `--scale`",
        _ => return None,
    })
}

const fn gait(error: &GaitError) -> Option<&'static str> {
    Some(match error {
        GaitError::NoPoints { .. } => "track with a body that has them, such as h32",
        GaitError::NoNumber { .. } => "take the folder as the run left it, or track again",
        GaitError::NoSteps { .. } => {
            "gait needs somebody who takes steps; angles over time are in angles.mot, and `sinew report` shows them"
        }
        _ => return None,
    })
}

const fn opensim(error: &OpensimError) -> Option<&'static str> {
    Some(match error {
        OpensimError::NoMarker { .. } => {
            "track with a body that has hips, knees, ankles and shoulders, such as h32; bodies of the model are \
             expected under the names of Rajagopal's (femur_r, tibia_r, talus_r, torso …)"
        }
        OpensimError::NoSpread { .. } => "take the folder as the run left it, or track again",
        _ => return None,
    })
}

const fn masks(error: &SegmentError) -> Option<&'static str> {
    Some(match error {
        SegmentError::OutOfRange { .. } => "`sinew segment --help` lists the flags with their defaults",
        SegmentError::NoBackground { .. } => {
            "images and background are matched by the names of the cameras; rename the files"
        }
        SegmentError::OtherSize { .. } => "images and background of a camera must have one size",
        _ => return None,
    })
}

const fn thickness(error: &ShapeFitError) -> Option<&'static str> {
    match error {
        ShapeFitError::Solids(_) => None,
        ShapeFitError::OtherSize { .. } => Some("resize the camera to its masks"),
        ShapeFitError::Nobody => Some("choose others with `--frames`"),
        _ => None,
    }
}
