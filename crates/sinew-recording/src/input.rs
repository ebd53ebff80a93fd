//! What is read of a recording, one frame at a time.
//!
//! Enter: folders of keypoints, masks and images, a calibration. Leave: cameras, the names of the keypoints, and for each frame the people and images in every view
//! ([`source::FrameSource`]). Must not know: bodies, set-ups, trackers and results.

pub(crate) mod error;
pub mod folder_contents;
pub mod footage;
pub mod frame;
pub mod image_folder;
pub mod in_memory;
pub mod lag;
pub mod limbs;
pub mod live;
pub mod missing_path;
pub mod one_after_another;
pub mod one_person;
pub mod pictures;
pub mod recording;
pub mod roll;
pub mod silhouettes;
pub mod size_misfit;
pub mod source;
pub mod up_axis;
pub mod upright;
pub mod world_turn;

pub use error::InputError;
