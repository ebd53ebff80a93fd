//! Keypoints of several views as points in space.

use sinew_observe::Camera;
use sinew_observe::cameras::offsets::{CameraNoise, Sighted, point_from_views};

/// A frame's keypoints in space: for each point of the layout, position and mean variance per axis.
pub type Points = Vec<Option<([f64; 3], f64)>>;

/// Keypoints in space, offsets removed.
#[must_use]
pub fn points_in_space(cameras: &[Camera], noise: &[CameraNoise], frame: &Sighted, least_confidence: f64) -> Points {
    let keypoints = frame.iter().map(Vec::len).max().unwrap_or(0);
    (0..keypoints)
        .map(|k| {
            let (found, _) = point_from_views(cameras, noise, frame, k, least_confidence)?;
            let variance = (0..3).map(|a| found.covariance[a][a]).sum::<f64>() / 3.0;
            Some((found.point, variance))
        })
        .collect()
}
