//! Calibrated cameras, what follows from several of them (triangulation, association, constant offsets), and the likelihoods of what they see.
//!
//! A model is made once ([`KeypointModel`], [`MarkerModel`], [`image_likelihood::ImageModel`], [`soft_silhouette::SoftSilhouetteModel`]); [`ObservationModel::bind`] takes a frame and gives a log density on the state of a body, in which cameras no longer appear. Nothing here knows of trackers or of
//! motion. Points are in the world in metres, z up; pixels have v pointing down.
//!
//! Two cameras see a point, and triangulation gives it back:
//!
//! ```
//! use sinew_observe::Camera;
//! use sinew_observe::triangulate::{Config, Seen, triangulate};
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
pub mod alignment;
pub mod assignment;
pub mod association;
pub mod background;
pub mod between_frames;
pub mod bit_image;
pub mod bystanders;
pub mod camera;
pub mod camera_error;
pub mod camera_lag;
pub mod cleaning;
pub mod clock_search;
pub mod colour_histogram;
pub mod contour_map;
pub mod cross_view;
pub mod distance_map;
pub mod drawn_errors;
pub mod edges;
mod error;
pub mod exchanged_limbs;
pub mod following;
pub mod frame_likelihood;
pub mod girth;
pub mod girth_with_pose;
pub mod golden_section;
pub mod identities;
pub mod identities_joining;
pub mod image_likelihood;
mod image_lookup;
pub mod image_score;
pub mod keypoint_likelihood;
pub mod keypoint_model;
mod lag_regression;
mod lane_projection;
pub mod lasting_errors;
pub mod lens;
pub mod map;
pub mod marker_likelihood;
pub mod marker_views;
pub mod mask_pose;
mod measurement;
pub mod mistakes;
pub mod model;
pub mod offsets;
mod outline;
pub mod own_contours;
pub mod pixel_fit;
pub mod point_velocity;
pub mod raster;
pub mod rgb_image;
pub mod sighting;
pub mod smoothing;
pub mod soft_silhouette;
pub mod solid_body;
pub mod straightened;
pub mod triangulate;
pub mod view_partition;
pub mod working_raster;
pub use camera::{Camera, Intrinsics, MIN_DEPTH_M, Projection};
pub use error::Error;
pub use keypoint_likelihood::KeypointLikelihood;
pub use keypoint_model::{Detection, KeypointFrame, KeypointModel, View};
pub use lens::Lens;
pub use map::Map;
pub use marker_likelihood::{MarkerLikelihood, MarkerModel};
pub use marker_views::{MarkerView, MarkerViewsLikelihood, MarkerViewsModel};
pub use mistakes::Mistakes;
pub use model::ObservationModel;
pub use rgb_image::RgbImage;
pub use sighting::Noise;
pub use working_raster::WorkingRaster;
