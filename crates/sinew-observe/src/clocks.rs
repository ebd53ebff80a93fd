//! How late cameras are, from how keypoints move.

pub mod between_frames;
pub mod camera_lag;
pub mod clock_search;
pub(crate) mod lag_regression;
pub mod point_velocity;
