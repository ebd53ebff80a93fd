//! Bodies and set-ups that cannot be used.

use crate::input;
use sinew_setup::{Error, SetupError};

pub(crate) fn help(error: &Error) -> Option<String> {
    match error {
        Error::Input(error) => input::help(error),
        Error::Setup(error) => recording(error),
        Error::Body(_) => Some("give one of these names or the path of a body file, which ends in .toml".into()),
        _ => None,
    }
}

fn recording(error: &SetupError) -> Option<String> {
    let fixed = match error {
        SetupError::ResizedImages { scale, .. } => {
            return Some(format!("`--image-scale {scale:.4}` if all images were resized so after the calibration"));
        }
        SetupError::Unsure { .. } => "check `confidence_scale`: it is the confidence that means certainty",
        SetupError::Behind(_) | SetupError::InvertedPoses { .. } => {
            "the calibration must give the camera from the world, `Xcam = R Xworld + t`"
        }
        SetupError::Nobody { .. } => "look at the keypoint files, and at `--setup-frames`",
        SetupError::NoSuchPerson { .. } => {
            "`--person` counts from 1; here, where nobody can be followed through the recording beforehand, the most complete person at the start is 1"
        }
        SetupError::NobodyUpright { .. } => {
            "give the direction that points up in the calibration's world: `--up X,Y,Z`"
        }
        SetupError::NoAgreement { .. } | SetupError::NoPose => {
            "check the calibration against the keypoints with `sinew inspect`"
        }
        SetupError::TooFewKeypoints { .. } => "check `--layout`",
        SetupError::SomebodyElse { .. } => {
            "choose who is tracked with `--person`, leave the camera out of `--cameras`, or look at the calibration with `sinew inspect`"
        }
        SetupError::OtherRate { .. } => {
            "resample the keypoints to one frame rate, or leave the camera out of `--cameras`"
        }
        SetupError::Millimetres(_) => "give the translations of the calibration in metres",
        SetupError::ImpossibleHeight { .. } => {
            "give translations in metres, and the camera from the world, `Xcam = R Xworld + t`"
        }
        SetupError::SegmentLengths { .. } => {
            "check `--layout` (`sinew inspect` says what the keypoints look like) and the unit of the calibration; `--any-size` takes the person as measured"
        }
        SetupError::Fast(_) => {
            "give the frame rate of the cameras with `--fps`; `--any-size` tracks the motion all the same"
        }
        SetupError::ExchangedCameras { .. } => {
            "exchange the names of the two in the calibration, or their folders of keypoints"
        }
        SetupError::NoPoseOfFile { .. } => {
            "name more of its points as the layout does; `sinew body h32` shows a body that has them"
        }
        SetupError::NoFlesh(_) => {
            "give the body file solids (`[[solid]]`), name its links as `sinew body h32` does, or use a method for keypoints"
        }
        SetupError::Unwritable(_) | SetupError::Lasting(_) | _ => return None,
    };
    Some(fixed.into())
}
