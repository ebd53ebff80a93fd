//! The loop of a run: observe a frame, step the tracker, record what came out.
//!
//! Enter: a source of frames, a set-up, settings. Leave: one [`FrameEstimate`](sinew_results::estimate::FrameEstimate) a frame, and what a stopped run is resumed from ([`checkpoint`]).
//! Must not know: the command line and the format of any file but its own checkpoint and spool.

pub mod checkpoint;
pub mod error;
pub mod job;
pub mod pipeline;

mod describe;
mod fixed_lag;
mod identity;
mod images;
mod lasting;
mod marginals;
mod motion_prior;
mod noted;
mod record;
mod restart;
mod scene;
mod smooth;
mod step_size;
mod trajectories;

pub use fixed_lag::LagWindow;
pub use images::{ImageState, Images};
pub use motion_prior::{check_latent_model, check_model, motion_prior, walk};
pub use pipeline::{Pipeline, State};
pub use scene::{Scene, SceneState};
pub use sinew_dynamics::backward_pass::TRAJECTORIES;
pub use sinew_setup::predictive::{Doubt, Lengths, Origins};
pub use smooth::{Spool, smooth};
pub use step_size::tune;
