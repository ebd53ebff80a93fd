//! Whether the sizes that a calibration gives are sizes of people.

use super::setup_error::SetupError;
use super::warning::SetupWarning;
use sinew_core::estimators::median;
use sinew_observe::Camera;

/// A body outside these multiples of the default is none.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.2..=5.0;
/// Body heights between a camera and the origin that are too many.
const FAR: f64 = 100.0;
/// Height of the default body, metres.
const HEIGHT_M: f64 = 1.75;

/// Median distance of the cameras from the origin, in the unit of the calibration.
fn usual_distance(cameras: &[Camera]) -> f64 {
    median(
        &mut cameras.iter().map(|camera| camera.centre().iter().map(|x| x * x).sum::<f64>().sqrt()).collect::<Vec<_>>(),
    )
}

/// Refuses units that make a body of the wrong size.
///
/// # Errors
/// The size is that of no person.
pub fn check_scale(cameras: &[Camera], scale: f64) -> Result<(), SetupError> {
    if PLAUSIBLE.contains(&scale) {
        return Ok(());
    }
    Err(match far_cameras(cameras) {
        Some(warning) if scale > 1.0 => SetupError::Millimetres(warning),
        _ => SetupError::ImpossibleHeight { height_m: scale * HEIGHT_M },
    })
}

/// Warns when cameras stand so far from the origin that metres are unlikely.
#[must_use]
pub fn far_cameras(cameras: &[Camera]) -> Option<SetupWarning> {
    let distance = usual_distance(cameras);
    (distance > FAR * HEIGHT_M).then_some(SetupWarning::Millimetres { distance, height: HEIGHT_M })
}
