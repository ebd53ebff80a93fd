//! Cameras and likelihoods.
pub mod association;
pub mod camera;
pub mod cross_view;
mod distortion;
mod error;
pub mod keypoint_likelihood;
pub mod marker_likelihood;
pub mod model;
pub mod offsets;
pub mod pixel_fit;
pub mod triangulate;
pub use camera::{Camera, Distortion, Intrinsics, MIN_DEPTH_M, Projection};
pub use error::Error;
pub use keypoint_likelihood::{Detection, KeypointFrame, KeypointLikelihood, KeypointModel, Noise, View};
pub use marker_likelihood::{MarkerLikelihood, MarkerModel};
pub use model::ObservationModel;
