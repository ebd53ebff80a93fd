//! Settings of a run, from the strongest source that names them.
//!
//! flag > environment (`SINEW_SEED`) > `sinew.toml` of the trial > `sinew.toml` of the folders above, up to one with `root = true` > default.
//!
//! The *trial* is the folder that holds the keypoint folder; without keypoints it is the current folder. `--config FILE` takes the place of the trial's file. Every value
//! knows its [`Origin`]. [`Resolved::to_toml`] repeats a run wherever it is started: paths in it are absolute, and it is its own root.

#[rustfmt::skip]
pub mod common;
pub mod file;
pub mod idle;
pub mod resolved;
pub mod setting;
mod setting_warnings;
pub mod settings;
pub mod table;
pub mod track;
pub mod value;

pub use resolved::{Resolved, Sources, resolve};
pub use setting::Origin;
pub use track::TrackConfig;
