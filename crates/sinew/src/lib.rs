//! Tracks a moving human body from calibrated cameras and returns, for every frame, a posterior over 3D poses.
//!
//! This crate joins the layers of the workspace and holds the program `sinew`. The layers are re-exported as modules; each can be used alone.

pub use sinew_body as body;
pub use sinew_core as core;
pub use sinew_dynamics as dynamics;
pub use sinew_formats as formats;
pub use sinew_observe as observe;
pub use sinew_samplers as samplers;
pub use sinew_tracking as tracking;

pub mod bodies;
pub mod config;
mod error;
pub mod estimate;
pub mod evaluation;
pub mod files;
pub mod inspect;
pub mod job;
pub mod motion;
pub mod output;
pub mod pipeline;
pub mod problem28;
pub mod recording;
pub mod setup;
pub mod synthetic;

pub use error::Error;
