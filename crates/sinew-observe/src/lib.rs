#![doc = include_str!("../README.md")]

pub mod association;
pub mod cameras;
pub mod clocks;
mod error;
pub mod frame_likelihood;
pub mod golden_section;
pub mod keypoints;
pub mod lasting;
pub mod model;
pub mod silhouettes;
pub use cameras::camera::{Camera, Intrinsics, MIN_DEPTH_M, Projection};
pub use cameras::lens::Lens;
pub use error::Error;
pub use keypoints::keypoint_likelihood::KeypointLikelihood;
pub use keypoints::keypoint_model::{Detection, KeypointFrame, KeypointModel, View};
pub use keypoints::mistakes::Mistakes;
pub use keypoints::sighting::Noise;
pub use model::ObservationModel;
pub use silhouettes::map::Map;
pub use silhouettes::rgb_image::RgbImage;
pub use silhouettes::working_raster::WorkingRaster;
