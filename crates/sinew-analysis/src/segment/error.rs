//! What is refused when masks are made from images.

use sinew_input::flag::flag;
use std::path::PathBuf;

/// Images or settings from which no masks can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SegmentError {
    /// A setting whose value is out of its range.
    #[error("{} is {value}; it must be {range}", flag(setting))]
    OutOfRange {
        /// Setting.
        setting: &'static str,
        /// Value given.
        value: f64,
        /// Values allowed.
        range: &'static str,
    },
    /// A camera without a background.
    #[error("no background for camera `{camera}`; {} has images of {}", quoted(folders), cameras.join(", "))]
    NoBackground {
        /// Camera.
        camera: String,
        /// Folders of backgrounds.
        folders: Vec<PathBuf>,
        /// Cameras that have one.
        cameras: Vec<String>,
    },
    /// An image of another size than the background.
    #[error("{file}: {}x{} pixels; the background of {camera} has {}x{}", size[0], size[1], background[0], background[1])]
    OtherSize {
        /// File.
        file: String,
        /// Camera.
        camera: String,
        /// Size of the image, pixels.
        size: [usize; 2],
        /// Size of the background, pixels.
        background: [usize; 2],
    },
}

fn quoted(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| format!("`{}`", folder.display())).collect::<Vec<_>>().join(", ")
}
