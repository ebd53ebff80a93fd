//! Likelihoods of detected keypoints, and the mistakes of detectors.

pub mod bystanders;
pub mod exchanged_limbs;
pub mod keypoint_likelihood;
pub mod keypoint_model;
pub mod mistakes;
pub mod pixel_fit;
pub mod sighting;
pub mod straightened;
