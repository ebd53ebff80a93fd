//! Pages, pictures and inspections that cannot be made.

use crate::{analysis, input};
use sinew_report::Error;
use sinew_report::inspect::{InspectError, Odd};
use sinew_report::overlay::OverlayError;

/// What the user can do about an error.
#[must_use]
pub fn help(error: &Error) -> Option<String> {
    match error {
        Error::Analysis(error) => analysis::help(error),
        Error::Inspect(error) => inspection(error).map(Into::into),
        Error::Overlay(error) => pictures(error).map(Into::into),
        _ => None,
    }
}

const fn inspection(error: &InspectError) -> Option<&'static str> {
    Some(match error {
        InspectError::TwoSkeletons { .. } => "inspect the motions of each skeleton by themselves",
        InspectError::UnknownKind { .. } => {
            "give a calibration, a set-up, configuration, body or mapping (.toml), a folder of keypoints, masks or images, a motion file (.trc, .c3d, .bvh, .mot, .csv, .asf with .amc), a motion model or latent model (.json), a result folder or its posterior.zarr"
        }
        InspectError::Video { .. } => {
            "run a 2D pose detector over the videos first, and inspect the folder of keypoints that it fills"
        }
        InspectError::NoPoints { .. } | InspectError::OtherMotion { .. } => {
            "give the true points of the recording that was tracked (.trc, .bvh or .csv), at the same times"
        }
        InspectError::NoStore { .. } => {
            "give the folder `posterior.zarr` itself, not one inside it, and no store of format 2"
        }
        _ => return None,
    })
}

const fn pictures(error: &OverlayError) -> Option<&'static str> {
    match error {
        OverlayError::Solids(_) => None,
        OverlayError::Scale { .. } => {
            Some("it is the size of the pictures over that of the calibrated images, for example 0.5")
        }
        OverlayError::NoImages => {
            Some("choose others with `--frames` and `--every`, or leave the folder of images out")
        }
        _ => None,
    }
}

/// Something odd about a file or folder, and what to do about it.
#[must_use]
pub fn odd(odd: &Odd) -> String {
    match odd {
        Odd::Words(words) => words.clone(),
        Odd::Refused(error) => match input::help(error) {
            Some(help) => format!("{error}; {help}"),
            None => error.to_string(),
        },
        Odd::Apart([(first, frames), (other, other_frames)]) => format!(
            "{first} has frames {}..{}, {other} has {}..{}; tracking needs `--trim`, and if cameras are numbered apart, `sinew sync --trim` finds by how much",
            frames.start, frames.end, other_frames.start, other_frames.end
        ),
        Odd::Stopped => "the run was stopped and can be resumed: the same command with `--resume`".into(),
        Odd::Unfinished => "the run is unfinished: the same command with `--resume` continues it".into(),
    }
}
