//! Calibrated cameras: lenses, projection, triangulation, and how they may differ from their calibration.

pub mod camera;
pub mod camera_error;
pub mod cross_view;
pub(crate) mod lane_projection;
pub mod lens;
pub mod offsets;
pub mod triangulate;
