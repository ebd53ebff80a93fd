//! Recordings and files that cannot be used.

use crate::formats;
use sinew_input::folder_contents::FolderContents;
use sinew_input::size_misfit::SizeMisfit;
use sinew_input::{Error, FileError, InputError, missing_path};
use std::io;

/// What to do with videos.
const DETECT: &str = "run a 2D pose detector over the videos first, for example OpenPose with `--write_json`, and give the folder that it fills";

pub(crate) fn help(error: &Error) -> Option<String> {
    match error {
        Error::Format(error) => formats::help(error),
        Error::Input(error) => recording(error),
        Error::Io(error) => file(error),
        Error::Config(_) => {
            Some("`sinew track --help` lists the settings; `--print-config` shows the values in force".into())
        }
        _ => None,
    }
}

fn recording(error: &InputError) -> Option<String> {
    Some(match error {
        InputError::NobodyForLayout { known, .. } => format!(
            "give keypoints that show somebody; if others of the files do, name the layout with `--layout`: {}",
            known.join(", ")
        ),
        InputError::NoSuchLength { known, .. } => {
            format!("known: {}; or give a mapping file with `--layout`", known.join(", "))
        }
        InputError::LayoutLacks { point, .. } => format!("name the keypoint `{point}` in the mapping file"),
        InputError::SizeChanges { many, .. } => {
            format!("all {many} of a camera must have one size; write this one again")
        }
        InputError::SizeMisfit { misfit, .. } => size(misfit),
        InputError::VideosForImages { videos, many, .. } => format!(
            "write their frames as {many} first, for example `ffmpeg -i {} cam01_%06d.png`",
            videos.first().map_or("cam01.mp4", String::as_str)
        ),
        InputError::FileForFolder { is_video: false, many, .. } => {
            format!("give the folder that holds the {many} of all cameras")
        }
        InputError::FileForFolder { many: "keypoints", .. } => DETECT.into(),
        InputError::FileForFolder { many, .. } => {
            format!("write its frames as {many} first, for example `ffmpeg -i cam01.mp4 cam01_%06d.png`")
        }
        InputError::FolderForFile { folder, contents } => match contents {
            FolderContents::Toml(files) => {
                let files: Vec<String> = files.iter().map(|file| format!("`{}`", file.display())).collect();
                format!("did you mean {}?", files.join(" or "))
            }
            FolderContents::Keypoints => {
                format!("it holds keypoints: give it with `--keypoints {}`", folder.display())
            }
            FolderContents::Videos(_) => DETECT.into(),
            FolderContents::Other => "give the path of a file".into(),
        },
        InputError::NoImages { many, .. } => format!("give the folder that holds the {many} of all cameras"),
        InputError::ImagesWithoutCamera { many, .. } => {
            format!("move the {many} of each camera into a folder of its name; is this the folder of one camera?")
        }
        InputError::FolderOfOneCamera { .. } => {
            "give the folder above it, which holds one folder `<camera>_json` for each camera; or move the files of each camera into a folder of its name".into()
        }
        InputError::UnknownKeypointFile { .. } => {
            "give such a file, the folder with a file of each camera, or the folder with a folder of each camera".into()
        }
        InputError::NoFrames { .. } => "run the detector again; the file has a header and nothing else".into(),
        InputError::FileOfNoCamera { .. } => {
            "files and cameras are matched by name: name the file after the camera, as in `cam01_results.json`".into()
        }
        InputError::TwoFiles { .. } => "keep one of the two in the folder, for example the filtered one of DeepLabCut".into(),
        InputError::LayoutsDiffer { .. } => "run the same model on all cameras, or name the points with `--layout`".into(),
        InputError::NoKeypoints { .. } => "`--keypoints` takes the folder that a detector fills, for example `pose`".into(),
        InputError::VideosForKeypoints { .. } => DETECT.into(),
        InputError::NoFiles { .. } => "fill the folder or remove it, or leave the camera out of `--cameras`".into(),
        InputError::NoSuchCamera { .. } => "give `--cameras` a list of these names, separated by commas".into(),
        InputError::LagOfNoCamera { .. } => "give `--lag` cameras by these names, for example `--lag cam_03=-2`".into(),
        InputError::NoKeypointsOfCamera { .. } => "leave the camera out of `--cameras`".into(),
        InputError::NoSuchFrames { .. } => "`--frames A..B` takes the numbers in the file names, A included, B not".into(),
        InputError::NoCommonFrame => "look at the frames of each camera with `sinew inspect`".into(),
        InputError::LagLeavesNoFrame { .. } => "give a smaller `--lag`; `sinew sync` says how late cameras are".into(),
        InputError::NumbersApart { in_one_file: true, .. } => {
            "correct the number that jumps (`image_id`, `frame`), or choose frames with `--frames A..B`".into()
        }
        InputError::NumbersApart { .. } => {
            "the last number in a file name must be the frame number, as in `cam01.0034.json`".into()
        }
        InputError::ImageScale { .. } => "the scale is their width over that of the calibrated images, for example 0.5".into(),
        InputError::ImagesOfOtherCameras { .. } => "files and cameras are matched by name; rename the files".into(),
        InputError::ImagesTwice { .. } => "move one kind elsewhere".into(),
        InputError::GradientsOfSilhouettes { .. } => {
            "give it the keypoints, too, without `--init`; or use `--method annealed`".into()
        }
        InputError::InitWithoutKeypoints => "give them with `--keypoints DIR`, or begin with `--init POINTS.trc`".into(),
        InputError::NoStart => {
            "give `--init POINTS.trc`, `--keypoints DIR --init keypoints`, or the `--setup` of an earlier run".into()
        }
        InputError::MarkerMissing { .. } => {
            "name the markers like the keypoints of BODY_25B, or begin with `--keypoints DIR --init keypoints`".into()
        }
        _ => return None,
    })
}

fn size(error: &SizeMisfit) -> String {
    match error.fitting {
        Some(scale) => {
            format!("if the {} were resized after the calibration, set `mask_scale = {scale}`", error.many)
        }
        None => format!("width and height do not fit together: are these the {} of {}?", error.many, error.camera),
    }
}

fn file(error: &FileError) -> Option<String> {
    let is_missing = matches!(error.source.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory);
    if is_missing { missing_path::advice(&error.path) } else { None }
}
