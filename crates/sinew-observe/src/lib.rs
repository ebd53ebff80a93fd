//! Cameras and likelihoods.
pub mod camera;
pub use camera::{Camera, Distortion, Intrinsics, MIN_DEPTH_M};
