//! The result folder: estimates in, files out, and the same files read again.
//!
//! Enter: a claimed folder, what a run says of itself ([`estimate::RunInfo`]), and one [`estimate::FrameEstimate`] after the other. Leave: the files of [`folder`], written under
//! provisional names and renamed when they are whole; what a stopped run may be resumed from ([`folder::Written`]).
//! Must not know: how a frame was tracked, and by which method.

pub mod error;
pub mod estimate;
pub mod folder;
pub mod people;
pub mod problem;
pub mod standing_trial;
pub mod stored_array;

mod actions;
mod chunks;
mod claim;
mod coordinates;
mod draws;
mod journal;
mod markers;
mod partial;
mod skeleton;
mod statistics;
mod stored_file;
mod summary;
mod table;
mod tables;
mod texts;

pub use claim::{
    Claim, LOCK_NAME, OWN_NAMES, RESULT_NAMES, claim, claim_in, claim_to_resume, is_in_use, is_incomplete,
    refuse_inputs,
};
pub use folder::{ResultFolder, Written, write_whole};
pub use markers::{REFERENCE_ORDER, order as marker_order};
pub use partial::Position;
pub(crate) use partial::{PartialFile, Place};
pub use sinew_recording::input::world_turn::WorldTurn;
pub use sinew_recording::posed_body::{Pose, pose, t_pose};
pub use sinew_recording::silhouette_overlap::SilhouetteOverlap;
pub use sinew_recording::storage::{Disk, Storage, StoredFile, UnsyncedDisk, sync_below};
pub use stored_file::read_stored;
pub use summary::{AnglesSummary, CameraSummary, Diagnostics, Ending, Limits, Summary};
pub use texts::Texts;
