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
pub mod silhouette_overlap;
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
mod pose;
mod skeleton;
mod statistics;
mod stopped;
mod summary;
mod table;
mod tables;
mod texts;
mod world_turn;

pub use claim::{
    Claim, LOCK_NAME, OWN_NAMES, RESULT_NAMES, claim, claim_in, claim_to_resume, is_in_use, refuse_inputs,
};
pub use folder::{ResultFolder, Written, write_whole};
pub use markers::{REFERENCE_ORDER, order as marker_order};
pub use partial::Position;
pub(crate) use partial::{PartialFile, Place};
pub use pose::{Pose, pose};
pub use sinew_recording::storage::{Disk, Scratch, Storage, StoredFile};
pub use skeleton::t_pose;
pub use stopped::is_stopped;
pub use summary::{AnglesSummary, CameraSummary, Diagnostics, Ending, Limits, Summary};
pub use texts::Texts;
pub use world_turn::WorldTurn;
