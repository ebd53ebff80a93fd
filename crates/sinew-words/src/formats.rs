//! Files that their readers refuse.

use sinew::formats::{Error, layout};

pub(crate) fn help(error: &Error) -> Option<String> {
    Some(match error {
        Error::NotUtf8 { .. } => "open the file in an editor and save it with the encoding UTF-8".into(),
        Error::TooLarge { .. } => "is this the right file? split the recording if it is".into(),
        Error::Truncated { .. } => "the program that wrote the file was probably stopped; write or copy it again".into(),
        Error::TooMany { .. } => "is this the right file? take out what is not needed if it is".into(),
        Error::TooDeep { .. } | Error::ImpossibleCount { .. } => "the file is damaged or of another kind; write or copy it again".into(),
        Error::OutOfRange { place, .. } => {
            let is_json = place.file.to_lowercase().ends_with(".json");
            let missing = if is_json { "; write null for a missing value" } else { "" };
            format!("every number must be finite{missing}")
        }
        Error::DecimalComma { .. } => "export with an English locale, so that numbers read 0.5 and not 0,5".into(),
        Error::KeypointCount { found, layout, .. } => {
            let fitting = layout::with_numbers(*found);
            if fitting.is_empty() {
                format!("no known layout has {found} numbers; is the detector's model really `{layout}`?")
            } else {
                let names: Vec<&str> = fitting.iter().map(|layout| layout.name.as_str()).collect();
                format!("these keypoints may be {}; set `--layout`", names.join(" or "))
            }
        }
        Error::UnknownLayout { .. } => "a mapping file is TOML with `points = [\"Nose\", \"LEye\", …]`, one name per keypoint, \"\" for none".into(),
        Error::DuplicateFrame { .. } => "keep one of the two; frames are numbered by the last number in the file name".into(),
        Error::FrameRanges { frames, other, other_frames, ends: (start, _), .. } if are_apart(*frames, *other_frames, *start) => format!(
            "they share no frame, so that `--trim` would leave nothing: if numbers run on from camera to camera, number each camera's frames by themselves, or say for each what is to be taken off: `--lag {other}={start}`; if a camera saw nobody meanwhile, leave it out of `--cameras`"
        ),
        Error::FrameRanges { .. } => "pass `--trim` to use only the frames that all cameras have; if keypoints are numbered apart, `sinew sync --trim` finds by how much".into(),
        Error::CameraCollision { .. } => "rename one of them".into(),
        Error::NoCalibration { .. } => "folders and calibration are matched by name; rename the folder or leave the camera out with `--cameras`".into(),
        Error::UnknownCalibration { .. } => "is this the right file? calibrations of these programs are read as they are, and `sinew convert` writes one for another; of other programs write the numbers into a Calib.toml".into(),
        Error::CameraUnwritable { .. } => "write another format: the formats of Pose2Sim, Caliscope, Anipose and OpenCV hold every camera".into(),
        Error::NotOrthonormal { .. } => "calibrate again or export the rotation with more digits".into(),
        Error::MirrorRotation { .. } => "export the calibration with right-handed axes (x right, y down, z forward)".into(),
        Error::TimeBackwards { .. } => "sort the rows by time".into(),
        Error::Syntax { .. } => "correct the place, or write the file again with the program that made it".into(),
        Error::BadValue { field, .. } => format!("correct `{field}`, or export the file again"),
        Error::MissingField { field, .. } => format!("add `{field}`, or export the file with a program that writes it"),
        Error::UnknownKey { .. } | Error::UnknownName { .. } => "correct the spelling, or take it out".into(),
        Error::DuplicateName { .. } => "rename or remove one of them".into(),
        Error::Unsupported { .. } => "write the file in a form that is read; the documentation of its format lists them".into(),
        Error::RowLength { .. } => "the row or the header is damaged; write the file again".into(),
        Error::NotTriples { .. } => "give each keypoint as x, y and confidence".into(),
        Error::Confidence { .. } => "`confidence_scale` is the confidence that means certainty: 100 for percent".into(),
        Error::NoFrameNumber { .. } => "rename the file, or take it out of the folder".into(),
        Error::TooManyPixels { .. } => "is this the right file? make the images smaller if it is, and declare their scale".into(),
        Error::MaskChannels { .. } => "write masks as PNG with one channel: 0 for the background, 255 for the person".into(),
        Error::MaskLevels { .. } => "choose the label of the person and write it as 255, all else as 0".into(),
        Error::Body { .. } => "`sinew body h32` shows a body that is valid".into(),
        _ => return None,
    })
}

/// Whether two cameras share no frame: one that begins `start` frames after the other.
const fn are_apart(frames: u64, other_frames: u64, start: i64) -> bool {
    start.unsigned_abs() >= if start < 0 { other_frames } else { frames }
}
