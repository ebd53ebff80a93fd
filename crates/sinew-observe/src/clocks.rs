//! How late cameras are, from how keypoints move.

pub mod between_frames;
pub mod clock_search;
pub mod lag_estimate;
pub(crate) mod lag_regression;
pub mod on_time;
pub mod point_velocity;
