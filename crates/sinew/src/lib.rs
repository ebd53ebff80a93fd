//! Tracks a moving human body from calibrated cameras and returns, for every frame, a posterior over 3D poses.
//!
//! This crate joins the layers of the workspace and holds the program `sinew`. The layers are re-exported as modules; each can be used alone.
//!
//! | module | what |
//! |---|---|
//! | [`recording`], [`synthetic`] | where frames come from: keypoint files, or a simulated walker |
//! | [`silhouettes`], [`pictures`] | masks and images of the same cameras, frame by frame |
//! | [`segment`] | masks from images and images of the background |
//! | [`setup`] | sizes of the person, offsets of the cameras, noise: one value |
//! | [`pipeline`] | frames to estimates |
//! | [`job`], [`output`] | a whole run with its result folder |
//! | [`tracked`], [`overlay`] | poses of a result folder, and pictures of them over what the cameras saw |
//! | [`shape_fit`] | thicknesses of a person from masks and tracked poses |
//! | [`config`] | settings with their origin |
//! | [`inspect`], [`motion`], [`bodies`] | what a file holds; motion files into each other; bodies by name or file |
//!
//! A synthetic walker is recorded by four virtual cameras, and the set-up pass finds how long his thighs are from the keypoints alone:
//!
//! ```
//! use sinew::input::source::FrameSource;
//! use sinew::setup::{self, Request};
//! use sinew_simulate::recording::{SyntheticRecording, Script};
//!
//! let mut recording = SyntheticRecording::new(&Script { duration_s: 1.5, ..Script::default() }, 1)?;
//! let (cameras, layout) = (recording.cameras.clone(), recording.layout.clone());
//! let frames: Vec<_> = recording.frames().map(|number| Ok((number, recording.people(number)?))).collect();
//!
//! let (found, _) = setup::set_up(&cameras, &layout, &Request::default(), frames)?;
//! let knee = found.tree().link_index("r_shin").ok_or("no knee")?;
//! let thigh_m = -found.tree().links()[knee].offset[2];
//! assert!((thigh_m - 0.43).abs() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
pub mod files;
pub mod input;
pub mod inspect;
pub mod methods;
pub mod motion;
pub mod overlay;
pub mod results;
pub mod segment;
pub mod setup;
pub mod shape_fit;
pub mod track;

pub use error::Error;
