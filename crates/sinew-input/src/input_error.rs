//! What is refused of a recording: folders, file names, frames, layouts and sizes.

use super::flag::flag_with;
use super::folder_contents::FolderContents;
use super::lag::ClockLag;
use super::size_misfit::SizeMisfit;
use sinew_formats::keypoint_formats;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A recording that cannot be read as it stands.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum InputError {
    /// Nobody shows which layout the keypoints have.
    #[error("{}: the detector found nobody in the {files} files looked at; the keypoint layout cannot be recognised", folder.display())]
    NobodyForLayout {
        /// Keypoint folder.
        folder: PathBuf,
        /// Files that were read.
        files: usize,
        /// Layouts with a name.
        known: Vec<&'static str>,
    },
    /// No layout has that number of keypoints.
    #[error("{}: {numbers} numbers a person fit no known layout", folder.display())]
    NoSuchLength {
        /// Keypoint folder.
        folder: PathBuf,
        /// Numbers in the list of a person.
        numbers: usize,
        /// Layouts with a name.
        known: Vec<&'static str>,
    },
    /// A layout lacks a point without which a body cannot be placed.
    #[error("layout `{layout}` has no {words}; the model needs it")]
    LayoutLacks {
        /// Layout.
        layout: String,
        /// The point.
        point: &'static str,
        /// The point in words.
        words: &'static str,
    },
    /// The folder of one camera in place of the folder of all.
    #[error("`{}` holds {files} keypoint files itself; expected a folder for each camera", folder.display())]
    FolderOfOneCamera {
        /// Folder.
        folder: PathBuf,
        /// Keypoint files in it.
        files: usize,
    },
    /// A file that is of no format of keypoints.
    #[error("`{}` is no keypoint file of a known kind; known: {known}", file.display())]
    UnknownKeypointFile {
        /// File.
        file: PathBuf,
        /// Known kinds.
        known: String,
    },
    /// A file of many frames without a frame.
    #[error("`{}` holds no frame", file.display())]
    NoFrames {
        /// File.
        file: PathBuf,
    },
    /// A file whose name, or a camera in it, is no camera of the calibration.
    #[error("`{}`: `{camera}` is or holds no name of one calibrated camera; calibrated: {}", file.display(), calibrated.join(", "))]
    FileOfNoCamera {
        /// File.
        file: PathBuf,
        /// Camera in the file, or its name.
        camera: String,
        /// Cameras of the calibration.
        calibrated: Vec<String>,
    },
    /// Two files of one camera.
    #[error("`{}` and `{}` are both of camera `{camera}`", first.display(), second.display())]
    TwoFiles {
        /// Camera.
        camera: String,
        /// A file.
        first: PathBuf,
        /// Another file.
        second: PathBuf,
    },
    /// Files of two cameras with other points.
    #[error("`{}` and `{}` have other keypoints", first.display(), second.display())]
    LayoutsDiffer {
        /// A file.
        first: PathBuf,
        /// Another file.
        second: PathBuf,
    },
    /// A folder without keypoints.
    #[error("`{}` holds no keypoints; expected folders `<camera>_json` with JSON files, or a file a camera", folder.display())]
    NoKeypoints {
        /// Folder.
        folder: PathBuf,
    },
    /// Videos where keypoints are expected.
    #[error("`{}` holds videos ({}) and no keypoints", folder.display(), few(videos))]
    VideosForKeypoints {
        /// Folder.
        folder: PathBuf,
        /// Names of the videos.
        videos: Vec<String>,
    },
    /// Videos where images are expected.
    #[error("`{}` holds videos ({}) and no {many}", folder.display(), few(videos))]
    VideosForImages {
        /// Folder.
        folder: PathBuf,
        /// Word for the images.
        many: &'static str,
        /// Names of the videos.
        videos: Vec<String>,
    },
    /// A file where a folder is expected.
    #[error("`{}` is {}; expected a folder of {many}", file.display(), if *is_video { "a video" } else { "a file" })]
    FileForFolder {
        /// File.
        file: PathBuf,
        /// Word for what the folder should hold.
        many: &'static str,
        /// Whether it is a video.
        is_video: bool,
    },
    /// A folder where a file is expected.
    #[error("`{}` is a folder; expected a file", folder.display())]
    FolderForFile {
        /// Folder.
        folder: PathBuf,
        /// What it holds.
        contents: FolderContents,
    },
    /// A camera's folder without files.
    #[error("`{}` holds no {kind}", folder.display())]
    NoFiles {
        /// Folder.
        folder: PathBuf,
        /// Word for the files.
        kind: String,
    },
    /// A camera that is requested and not calibrated.
    #[error("no camera `{name}` in the calibration; calibrated: {}", calibrated.join(", "))]
    NoSuchCamera {
        /// Requested name.
        name: String,
        /// Cameras of the calibration.
        calibrated: Vec<String>,
    },
    /// A lag of a camera that is not calibrated.
    #[error("`lag` names no camera of the calibration: `{name}`; calibrated: {}", calibrated.join(", "))]
    LagOfNoCamera {
        /// Name given.
        name: String,
        /// Cameras of the calibration.
        calibrated: Vec<String>,
    },
    /// A camera that is requested and has no keypoints.
    #[error("no keypoints for camera `{name}`; folders: {}", folders.join(", "))]
    NoKeypointsOfCamera {
        /// Requested name.
        name: String,
        /// Folders with keypoints.
        folders: Vec<String>,
    },
    /// Frames that the recording does not have.
    #[error("frames {}..{} were requested; the recording has {}..{}", asked.start, asked.end, available.start, available.end)]
    NoSuchFrames {
        /// Requested frames.
        asked: Range<u64>,
        /// Frames of the recording.
        available: Range<u64>,
    },
    /// Cameras that have no frame in common.
    #[error("no frame is in all cameras")]
    NoCommonFrame,
    /// A lag with which cameras have no frame in common.
    #[error("no frame is in all cameras if `{camera}` is {lag} frames late (`lag`): it has {frames} frames")]
    LagLeavesNoFrame {
        /// Camera with the largest lag.
        camera: String,
        /// Its lag.
        lag: ClockLag,
        /// Its frames.
        frames: u64,
    },
    /// Frame numbers that are too large for the number of files.
    #[error("frame numbers run from {first} to {last}, but there are only {files} {} a camera", if *in_one_file { "frames in the file of" } else { "files" })]
    NumbersApart {
        /// First number.
        first: u64,
        /// Last number.
        last: u64,
        /// Most files of a camera, or frames in its file.
        files: u64,
        /// Whether they lie in one file.
        in_one_file: bool,
    },
    /// A scale of images that is no positive number.
    #[error("the scale of the {many} is {scale}; it must be greater than 0")]
    ImageScale {
        /// Word for the images.
        many: &'static str,
        /// The scale.
        scale: f64,
    },
    /// Images of other cameras than those in use.
    #[error("`{}` holds {many} of {}, none of the cameras in use: {}", folder.display(), found.join(", "), cameras.join(", "))]
    ImagesOfOtherCameras {
        /// Folder.
        folder: PathBuf,
        /// Word for the images.
        many: &'static str,
        /// Cameras of the files.
        found: Vec<String>,
        /// Cameras in use.
        cameras: Vec<String>,
    },
    /// An image of another size than the camera's first.
    #[error("{file}: {}x{} pixels; the {many} of {camera} read before are {}x{}", size[0], size[1], first[0], first[1])]
    SizeChanges {
        /// File.
        file: String,
        /// Word for the images.
        many: &'static str,
        /// Camera.
        camera: String,
        /// Size of this image, pixels.
        size: [usize; 2],
        /// Size of the camera's first image, pixels.
        first: [usize; 2],
    },
    /// An image of another size than its camera's.
    #[error("{file}: {misfit}")]
    SizeMisfit {
        /// File.
        file: String,
        /// The sizes.
        misfit: SizeMisfit,
    },
    /// A folder without images.
    #[error("`{}` holds no {many} (.{}); {}", folder.display(), extensions.join(", ."), expected_names(extensions))]
    NoImages {
        /// Folder.
        folder: PathBuf,
        /// Word for the images.
        many: &'static str,
        /// Extensions that are read.
        extensions: &'static [&'static str],
    },
    /// Images side by side and in folders.
    #[error("`{}` holds {many} and folders with {many}; {}", folder.display(), expected_names(extensions))]
    ImagesTwice {
        /// Folder.
        folder: PathBuf,
        /// Word for the images.
        many: &'static str,
        /// Extensions that are read.
        extensions: &'static [&'static str],
    },
    /// Images whose names do not say which camera took them.
    #[error("`{}` holds {many} without the name of a camera; {}", folder.display(), expected_names(extensions))]
    ImagesWithoutCamera {
        /// Folder.
        folder: PathBuf,
        /// Word for the images.
        many: &'static str,
        /// Extensions that are read.
        extensions: &'static [&'static str],
    },
    /// A method with gradients and nothing but silhouettes.
    #[error("method `{method}` cannot track from silhouettes alone")]
    GradientsOfSilhouettes {
        /// Method.
        method: &'static str,
    },
    /// A start from keypoints that are not given.
    #[error("{} without keypoints", flag_with("init", "keypoints"))]
    InitWithoutKeypoints,
    /// Silhouettes without a start.
    #[error("silhouettes alone do not say where the person is at first, and how large")]
    NoStart,
    /// A file of points without a point that the set-up needs.
    #[error("{file}: no marker `{point}`; the set-up needs {words}, and found {}", if markers.is_empty() { "none".into() } else { markers.join(", ") })]
    MarkerMissing {
        /// File.
        file: String,
        /// The point.
        point: &'static str,
        /// The point in words.
        words: &'static str,
        /// Markers of the file.
        markers: Vec<String>,
    },
}

/// Names that are listed.
const FEW: usize = 3;

fn few(names: &[String]) -> String {
    let more = if names.len() > FEW { ", …" } else { "" };
    format!("{}{more}", names.iter().take(FEW).cloned().collect::<Vec<_>>().join(", "))
}

fn expected_names(extensions: &[&str]) -> String {
    let extension = extensions.first().copied().unwrap_or_default();
    format!("expected files `<camera>_<frame>.{extension}` or folders `<camera>` with files `<frame>.{extension}`")
}

impl InputError {
    /// A file that is of no format of keypoints.
    #[must_use]
    pub fn unknown_keypoint_file(file: &Path) -> Self {
        Self::UnknownKeypointFile { file: file.to_owned(), known: keypoint_formats::known() }
    }
}
