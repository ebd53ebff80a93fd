//! Likelihoods of silhouettes, edges and colours, and the masks that they are taken from.

pub mod alignment;
pub mod background;
pub mod bit_image;
pub mod cleaning;
pub mod colour_histogram;
pub mod contour_map;
pub mod distance_map;
pub mod edges;
pub mod girth;
pub mod girth_with_pose;
pub mod image_likelihood;
pub(crate) mod image_lookup;
pub mod image_score;
pub mod map;
pub mod mask_pose;
pub(crate) mod measurement;
pub(crate) mod outline;
pub mod own_contours;
pub mod raster;
pub mod rgb_image;
pub mod smoothing;
pub mod soft_silhouette;
pub mod solid_body;
pub mod working_raster;
