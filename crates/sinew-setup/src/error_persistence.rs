//! How long errors of keypoints last, from the residuals of frames.

use super::lasting_errors::LASTING_SHARE;
use sinew_core::estimators::mean;
use sinew_observe::lasting::lasting_errors::{FrameResidual, LinearisedFrame};

/// Correlation of the residuals of successive frames, bias taken off, and how many pairs it is of.
pub(super) fn correlation(frames: &[LinearisedFrame], cameras: usize, points: usize) -> (f64, f64) {
    let mut series: Vec<Vec<[f64; 2]>> = vec![vec![[f64::NAN; 2]; frames.len()]; cameras * points];
    for (f, frame) in frames.iter().enumerate() {
        for &FrameResidual { camera, point, residual_px, noise_px2, .. } in &frame.residuals {
            series[camera * points + point][f] = residual_px.map(|r| r / noise_px2.sqrt());
        }
    }
    // Gross errors do not last.
    const GROSS: f64 = 4.0;
    let (mut product, mut square, mut pairs) = (0.0, 0.0, 0.0);
    for series in &series {
        for axis in 0..2 {
            let kept: Vec<f64> =
                series.iter().map(|r| r[axis]).map(|r| if r.abs() < GROSS { r } else { f64::NAN }).collect();
            let known: Vec<f64> = kept.iter().copied().filter(|r| r.is_finite()).collect();
            let mean = mean(&known);
            for pair in kept.windows(2).filter(|pair| pair.iter().all(|r| r.is_finite())) {
                product += (pair[0] - mean) * (pair[1] - mean);
                square += 0.5 * ((pair[0] - mean).powi(2) + (pair[1] - mean).powi(2));
                pairs += 1.0;
            }
        }
    }
    (product / square, pairs)
}

/// The time constant τ of errors whose correlation after some seconds is `found`, of as many independent `pairs`: the most probable with ln τ ~ N(ln 0.1, 1) and Fisher's variance (1 − ρ²)²/n. The prior without pairs.
pub(super) fn persistence_s(found: f64, pairs: f64, seconds: f64) -> f64 {
    const USUAL_S: f64 = 0.1;
    const CELLS: i32 = 400;
    const REACH: f64 = 5.0;
    let log = |z: f64| {
        let expected = LASTING_SHARE * (-seconds / (USUAL_S * z.exp())).exp();
        let said = if pairs > 0.0 { pairs * ((found - expected) / (1.0 - expected * expected)).powi(2) } else { 0.0 };
        -0.5 * (said + z * z)
    };
    let cells = (-CELLS..=CELLS).map(|cell| REACH * f64::from(cell) / f64::from(CELLS));
    USUAL_S * cells.max_by(|a, b| log(*a).total_cmp(&log(*b))).map_or(1.0, f64::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_constant_is_that_of_the_correlation_where_there_are_many_pairs() {
        let after = |seconds: f64, tau: f64| LASTING_SHARE * (-seconds / tau).exp();
        for (seconds, tau) in [(1.0 / 60.0, 0.1), (0.1, 0.3), (1.0 / 60.0, 0.02)] {
            let found = persistence_s(after(seconds, tau), 1e5, seconds);
            assert!((found / tau).ln().abs() < 0.02, "{found} for {tau}");
        }
        assert_eq!(persistence_s(f64::NAN, 0.0, 0.1), 0.1);
        let white = persistence_s(0.0, 1e4, 1.0 / 60.0);
        assert!(after(1.0 / 60.0, white) < 0.03, "{white}");
    }
}
