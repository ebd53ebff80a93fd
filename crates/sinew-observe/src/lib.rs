//! Calibrated cameras, what follows from several of them (triangulation, association, constant offsets), and the likelihoods of what they see.
//!
//! A model is made once ([`KeypointModel`], [`MarkerModel`], [`image_likelihood::ImageModel`], [`soft_silhouette::SoftSilhouetteModel`]); [`ObservationModel::bind`] takes a frame and gives a log density on the state of a body, in which cameras no longer appear. Nothing here knows of trackers or of
//! motion. Points are in the world in metres, z up; pixels have v pointing down.
//!
//! Two cameras see a point, and triangulation gives it back:
//!
//! ```
//! use sinew_observe::Camera;
//! use sinew_observe::cameras::triangulate::{Config, Seen, triangulate};
//!
//! let target = [0.0, 0.0, 1.0];
//! let left = Camera::look_at("left", [1280.0, 960.0], 900.0, [-3.0, -4.0, 2.0], target)?;
//! let right = Camera::look_at("right", [1280.0, 960.0], 900.0, [3.0, -4.0, 2.0], target)?;
//!
//! let wrist = [0.3, 0.2, 1.4];
//! let seen: Vec<Seen<'_>> = [&left, &right]
//!     .into_iter()
//!     .filter_map(|camera| Some(Seen { camera, pixel: camera.project(wrist).pixel()?, confidence: 0.9 }))
//!     .collect();
//! let found = triangulate(&seen, &Config::default()).expect("two cameras see it");
//! assert!(found.error_px < 1e-6);
//! assert!((0..3).all(|k| (found.point[k] - wrist[k]).abs() < 1e-9));
//! # Ok::<(), sinew_observe::Error>(())
//! ```
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
pub use keypoints::marker_likelihood::{MarkerLikelihood, MarkerModel};
pub use keypoints::marker_views::{MarkerView, MarkerViewsLikelihood, MarkerViewsModel};
pub use keypoints::mistakes::Mistakes;
pub use keypoints::sighting::Noise;
pub use model::ObservationModel;
pub use silhouettes::map::Map;
pub use silhouettes::rgb_image::RgbImage;
pub use silhouettes::working_raster::WorkingRaster;
