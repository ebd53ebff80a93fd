//! The result folder: estimates in, files out, and the same files read again.
//!
//! Enter: a claimed folder, what a run says of itself ([`estimate::RunInfo`]), and one [`estimate::FrameEstimate`] after the other. Leave: the files of [`folder`], written under
//! provisional names and renamed when they are whole; what a stopped run may be resumed from ([`folder::Written`]).
//! Must not know: how a frame was tracked, and by which method.

pub mod action_trace;
mod derived;
mod error;
pub mod estimate;
pub mod folder;
pub mod folder_table;
pub mod people;
pub mod problem;
mod read_error;
pub mod result_table;
mod results_error;
pub mod standing_trial;
mod storage;
pub mod stored_array;
pub mod tracked;

mod actions;
mod chunks;
mod claim;
mod coordinates;
mod draws;
mod journal;
mod markers;
mod own_files;
mod partial;
mod place;
mod skeleton;
mod staged;
mod statistics;
mod stored_file;
mod summary;
mod tables;
mod texts;
mod without_summary;

pub use claim::{
    Claim, OWN_NAMES, RESULT_NAMES, claim, claim_in, claim_to_resume, is_in_use, is_incomplete, refuse_inputs,
};
pub use derived::{ANGLE_DRAWS_NAME, COMPARISON_NAMES, GAIT_NAMES, PAGE_NAME, refuse_other_page};
pub use error::Error;
pub use folder::{ResultFolder, Written};
pub use markers::{REFERENCE_ORDER, order as marker_order};
pub use own_files::{LIST_NAME, LOCK_NAME, add_own, is_own, list_derived, own_place};
pub use partial::{FilePlace, PartialFile, Position, write_whole, write_whole_in};
pub use place::place;
pub use staged::Staged;

pub use read_error::ReadError;
pub use results_error::{Expected, Occupied, ResultsError};
pub use storage::{Disk, Storage, StoredFile, UnsyncedDisk, sync_below};
pub use stored_file::read_stored;
pub use summary::{AnglesSummary, CameraSummary, Diagnostics, Ending, Limits, Summary};
pub use texts::Texts;
pub use without_summary::without_summary;
