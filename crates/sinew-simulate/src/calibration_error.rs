//! How far cameras are from their calibration, and how late their clocks are.

use crate::draws::{normals, uniforms};
use sinew_core::random::Stage;
use sinew_observe::Camera;
use sinew_observe::cameras::camera_error::{NUMBERS, with_error};

/// Standard deviations of a camera's errors; the errors of one camera share a factor 1/√w, w ~ Gamma(2, 2), so that one camera of several is off by more than the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CalibrationError {
    /// Turn about each axis, radians.
    pub turn: f64,
    /// Place along each axis, metres.
    pub place_m: f64,
    /// Focal length, as a share.
    pub focal: f64,
    /// Principal point along each axis, in units of the focal length.
    pub principal_point: f64,
    /// First radial coefficient.
    pub k1: f64,
    /// Lag of a clock, frames; its errors have a factor of their own.
    pub lag_frames: f64,
    /// Whether they share that factor.
    pub heavy_tails: bool,
}

impl CalibrationError {
    /// Cameras that are what their calibration says.
    pub const NONE: Self = Self {
        turn: 0.0,
        place_m: 0.0,
        focal: 0.0,
        principal_point: 0.0,
        k1: 0.0,
        lag_frames: 0.0,
        heavy_tails: false,
    };

    /// What a calibration with a board or a wand leaves, from a few metres: 0.2°, 5 mm, 0.3 %, 2 mrad; clocks are off by more than with one trigger, and by less than in clips that were cut to whole frames.
    pub const USUAL: Self = Self {
        turn: 3.5e-3,
        place_m: 5e-3,
        focal: 3e-3,
        principal_point: 2e-3,
        k1: 0.02,
        lag_frames: 0.15,
        heavy_tails: true,
    };

    /// The same errors times a factor.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            turn: factor * self.turn,
            place_m: factor * self.place_m,
            focal: factor * self.focal,
            principal_point: factor * self.principal_point,
            k1: factor * self.k1,
            lag_frames: factor * self.lag_frames,
            ..*self
        }
    }
}

/// The cameras as they are, where these are their calibrations.
#[must_use]
pub fn as_they_are(calibrated: &[Camera], error: &CalibrationError, stage: &Stage) -> Vec<Camera> {
    let CalibrationError { turn, place_m, focal, principal_point, k1, heavy_tails, .. } = *error;
    let sd = [turn, turn, turn, place_m, place_m, place_m, focal, principal_point, principal_point, k1];
    let one = |(index, camera): (usize, &Camera)| {
        let stage = stage.round(index);
        let normal = normals(&stage, 0, NUMBERS);
        let tail = tail(&stage, heavy_tails);
        let error: [f64; NUMBERS] = std::array::from_fn(|k| sd[k] * normal[k] * tail);
        with_error(camera, &error)
    };
    calibrated.iter().enumerate().map(one).collect()
}

/// Lags of the clocks of some cameras, frames.
#[must_use]
pub fn lags_frames(cameras: usize, error: &CalibrationError, stage: &Stage) -> Vec<f64> {
    let lag = |camera| {
        let stage = stage.round(camera);
        error.lag_frames * normals(&stage, 0, 1)[0] * tail(&stage, error.heavy_tails)
    };
    (0..cameras).map(lag).collect()
}

/// 1/√w, w ~ Gamma(2, 2).
fn tail(stage: &Stage, heavy: bool) -> f64 {
    let weight = || -0.5 * uniforms(stage, 1, 2).iter().map(|u| (1.0 - u).ln()).sum::<f64>();
    if heavy { weight().sqrt().recip() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_have_their_standard_deviations() {
        let camera = Camera::look_at("C1", [1280.0, 960.0], 900.0, [3.0, -2.0, 2.2], [0.0, 0.0, 1.0]).unwrap();
        let cameras = vec![camera.clone(); 4000];
        let steady = CalibrationError { heavy_tails: false, ..CalibrationError::USUAL };
        let spread = |error: &CalibrationError| {
            let drawn = as_they_are(&cameras, error, &Stage::new(3, "test"));
            let place = |c: &Camera| c.translation[0] - camera.translation[0];
            (
                drawn.iter().map(|c| (c.intrinsics.fx / 900.0).ln().powi(2)).sum::<f64>() / 4000.0,
                drawn.iter().map(|c| place(c).powi(2)).sum::<f64>() / 4000.0,
            )
        };
        let (focal, _) = spread(&steady);
        assert!((focal.sqrt() / 3e-3 - 1.0).abs() < 0.05, "{focal}");
        // Student's t with four degrees of freedom has twice the variance.
        let (heavy, _) = spread(&CalibrationError::USUAL);
        assert!((heavy / focal - 2.0).abs() < 0.5, "{heavy} for {focal}");
        let lags = lags_frames(4000, &steady, &Stage::new(3, "test"));
        let square = lags.iter().map(|lag| lag * lag).sum::<f64>() / 4000.0;
        assert!((square.sqrt() / 0.15 - 1.0).abs() < 0.05, "{square}");
        assert_eq!(as_they_are(&cameras[..1], &CalibrationError::NONE, &Stage::new(3, "test")), cameras[..1]);
    }
}
