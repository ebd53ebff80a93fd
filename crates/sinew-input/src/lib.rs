//! Recordings of people by calibrated cameras, on disk or live: what is read of them, one frame at a time.
//!
//! Enter: folders of keypoints, masks and images, a calibration. Leave: cameras, the names of the keypoints, and for each frame the people and images in every view
//! ([`source::FrameSource`]); who is who in them ([`roll`]). Must not know: bodies, set-ups, trackers and results.
//!

mod error;
mod file_error;
pub mod files;
pub mod flag;
pub mod folder_contents;
pub mod footage;
pub mod frame;
pub mod image_folder;
pub mod in_memory;
mod input_error;
pub mod lag;
pub mod limbs;
pub mod live;
pub mod missing_path;
pub mod one_after_another;
pub mod pictures;
mod problems;
pub mod recording;
pub mod roll;
pub mod silhouettes;
pub mod size_misfit;
pub mod source;
pub mod up_axis;
pub mod upright;
pub mod world_turn;

pub use error::Error;
pub use file_error::FileError;
pub use input_error::InputError;
pub use problems::Problems;
