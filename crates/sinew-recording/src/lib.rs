//! Recordings of people by calibrated cameras: what their files hold, and what follows from them before tracking.
//!
//! | module | what |
//! |---|---|
//! | [`input`] | keypoints, masks and images of a recording, one frame at a time |
//! | [`setup`] | sizes of the person, offsets of the cameras, noise: one value |
//! | [`oddities`] | cameras that exchange sides for a span, people who jump |
//! | [`posed_body`] | frames of all links and points of a body in a state |
//! | [`predictive`] | whether keypoints scatter about poses as the model says |
//! | [`bodies`] | bodies by name or file |
//! | [`files`] | whole files with a limit on their size |
//! | [`silhouette_overlap`] | how well a body covers the silhouettes of a camera |
//! | [`storage`] | the few operations on files that results need |
//!
//! No tracker, no sampler and no result is known here.

pub mod bodies;
pub mod body_limits;
mod error;
mod file_error;
pub mod files;
pub mod input;
pub mod oddities;
pub mod posed_body;
pub mod predictive;
mod problems;
pub mod setup;
pub mod silhouette_overlap;
pub mod storage;

pub use error::Error;
pub use file_error::FileError;
pub use problems::Problems;
