//! Where a camera's lag enters the likelihood: detections are moved to where a camera that is not late would have made them, before they are bound.

use crate::cameras::camera::Camera;
use crate::keypoints::keypoint_model::Detection;

/// Detections as a camera would have made them that is not late: moved by how far each point, predicted at `at` and moving with its velocity, went since.
#[must_use]
pub fn on_time(
    camera: &Camera,
    detections: &[Option<Detection>],
    at: &[f64],
    velocities: &[[f64; 3]],
    lag_s: f64,
) -> Vec<Option<Detection>> {
    let points = at.as_chunks::<3>().0.iter().zip(velocities);
    let shown = |(detection, (at, velocity)): (&Option<Detection>, (&[f64; 3], &[f64; 3]))| {
        let seen = (*detection)?;
        let before = [0, 1, 2].map(|k: usize| at[k] - lag_s * velocity[k]);
        let moved = camera.project(*at).pixel().zip(camera.project(before).pixel());
        let [du, dv] = moved.map_or([0.0; 2], |(now, before)| [now[0] - before[0], now[1] - before[1]]);
        Some(Detection { pixel: [seen.pixel[0] + du, seen.pixel[1] + dv], ..seen })
    };
    detections.iter().zip(points).map(shown).collect()
}
