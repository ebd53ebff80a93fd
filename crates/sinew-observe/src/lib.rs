//! Cameras and likelihoods.
pub mod camera;
pub mod keypoint_likelihood;
pub mod marker_likelihood;
pub mod model;
pub use camera::{Camera, Distortion, Intrinsics, MIN_DEPTH_M};
pub use keypoint_likelihood::{Detection, KeypointFrame, KeypointLikelihood, KeypointModel, Noise, View};
pub use marker_likelihood::{MarkerLikelihood, MarkerModel};
pub use model::ObservationModel;
