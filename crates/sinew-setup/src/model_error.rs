//! How far the detector's keypoints lie from the body's points.
//!
//! It is what the scatter of triangulated points about the fitted body has more than the points' own errors.

use sinew_core::estimators::median;
use sinew_observe::cameras::offsets::robust_sigma;

/// The model error is at least this share of the scatter, in variance: what the triangulated points say of their own error is not exact.
const LEAST_SHARE: f64 = 0.25;
/// No body is exact to less, metres.
const LEAST_ERROR_M: f64 = 0.002;

/// Model error per axis, metres, from the residuals (metres, one a coordinate) of fitted poses with `taken` free parameters in all, and the variances per axis of the triangulated points.
pub(super) fn model_error_m(residuals: &[f64], taken: f64, variances: &mut [f64]) -> f64 {
    let count = residuals.len() as f64;
    let freedom = count / (count - taken).max(0.25 * count);
    let spread = robust_sigma(residuals.iter().copied()).powi(2) * freedom;
    (spread - median(variances)).max(LEAST_SHARE * spread).sqrt().max(LEAST_ERROR_M)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_points_themselves_are_taken_off() {
        // A scatter of 5 mm as the median absolute deviation sees it, 3 mm of it known.
        let residuals: Vec<f64> = (0..1000).map(|i| if i % 2 == 0 { 0.005 } else { -0.005 } / 1.4826).collect();
        let found = |own: f64| model_error_m(&residuals, 0.0, &mut [own * own; 3]);
        assert!((found(0.003) - 0.004).abs() < 2e-5, "{}", found(0.003));
        assert!((found(0.1) - 0.0025).abs() < 2e-5, "at least a quarter of the variance");
        assert!(model_error_m(&[1e-6; 12], 0.0, &mut [0.0]) >= 0.002);
        assert!(model_error_m(&residuals, 500.0, &mut [0.0]) > 0.0069, "fitted parameters hide scatter");
    }
}
