//! Quadrature against the stored exact references, and the densities of the camera point.

use sinew::core::density::{GradLogDensity, LogDensity};
use sinew_tests::camera_point::CameraPoint;
use sinew_tests::depth_flip::Arm;
use sinew_tests::growth::Growth;
use sinew_tests::quadrature::{Axis, integrate};
use sinew_tests::stored::number;

/// Log likelihood, means and variances to 1e-9 (stored to 1e-13 on 2001 points); signs to the 1e-4 of their own error.
#[test]
fn quadrature_equals_the_stored_filter_of_the_growth_model() {
    let Some(growth) = Growth::stored() else { return };
    let exact = growth.exact(1601);
    let log: f64 = exact.iter().map(|f| f.log_likelihood).sum();
    assert!((log - growth.log_likelihood).abs() < 1e-9, "{log} against {}", growth.log_likelihood);
    for (frame, found) in exact.iter().enumerate() {
        let [mean, variance] = growth.moments[frame];
        assert!((found.mean - mean).abs() < 1e-9, "frame {frame}: {} against {mean}", found.mean);
        assert!((found.variance - variance).abs() < 1e-9, "frame {frame}: {} against {variance}", found.variance);
        let off = (found.positive - growth.positive[frame]).abs();
        assert!(off < 1e-4, "frame {frame}: P(x > 0) off by {off}");
    }
    let modes = growth.positive.iter().filter(|p| (0.05..=0.95).contains(*p)).count();
    assert_eq!(modes, 28, "frames with both signs above 5 %");
}

/// Evidence to 1e-9 (stored to 1e-13), masses to the 1e-6 of their own error, moments to 1e-9 but for angles beyond ±π.
#[test]
fn quadrature_equals_the_stored_posterior_of_the_depth_flip() {
    let Some(arm) = Arm::stored() else { return };
    let exact = arm.exact(13);
    assert!(
        (exact.log_evidence - arm.log_evidence).abs() < 1e-9,
        "{} against {}",
        exact.log_evidence,
        arm.log_evidence
    );
    for (mode, (found, stored)) in exact.masses.iter().zip(&arm.masses).enumerate() {
        assert!((found - stored).abs() < 2e-6, "mode {mode}: {found} against {stored}");
    }
    let stored = sinew_tests::stored::numbers(&arm.stored["posterior_mean"]);
    for (found, stored) in exact.moments.mean.iter().zip(&stored) {
        assert!((found - stored).abs() < 1e-9, "{found} against {stored}");
    }
    let covariance = sinew_tests::linear_series::rows(&arm.stored["posterior_cov"]).concat();
    for (found, stored) in exact.moments.covariance.iter().zip(&covariance) {
        assert!((found - stored).abs() < 1e-9, "{found} against {stored}");
    }
}

/// `camera-point`: the log joint at two points to 1e-9, the gradient against differences, the evidence and moments by quadrature.
#[test]
fn the_camera_point_has_the_stored_density_and_moments() {
    let Some(point) = CameraPoint::stored() else { return };
    let target = point.target();
    let m0 = sinew_tests::stored::numbers(&point.stored["m0"]);
    for (x, name) in [(&point.mode, "log_joint_at_map"), (&m0, "log_joint_at_m0")] {
        let (found, stored) = (target.log_density(x), number(&point.stored[name]));
        assert!((found - stored).abs() < 1e-9, "{name}: {found} against {stored}");
        let mut gradient = [0.0; 3];
        target.log_density_grad(x, &mut gradient);
        for j in 0..3 {
            let at = |h: f64| {
                let mut x = x.clone();
                x[j] += h;
                target.log_density(&x)
            };
            let numeric = (at(1e-6) - at(-1e-6)) / 2e-6;
            let scale = gradient.iter().fold(1.0_f64, |a, g| a.max(g.abs()));
            assert!((numeric - gradient[j]).abs() < 1e-5 * scale, "{name}: {numeric} against {}", gradient[j]);
        }
    }
    let axis = |j: usize| {
        let sd = point.moments.covariance[4 * j].sqrt();
        Axis::new(&[point.mode[j] - 9.0 * sd, point.mode[j], point.mode[j] + 9.0 * sd], 5)
    };
    let exact = integrate(&target, &[axis(0), axis(1), axis(2)], 1, |_| 0);
    let off = (exact.log_evidence - point.log_evidence).abs();
    assert!(off < 1e-9, "log evidence off by {off}");
    for (found, stored) in exact.moments.mean.iter().zip(&point.moments.mean) {
        assert!((found - stored).abs() < 1e-11, "{found} against {stored}");
    }
    for (found, stored) in exact.moments.covariance.iter().zip(&point.moments.covariance) {
        assert!((found - stored).abs() < 1e-13, "{found} against {stored}");
    }
}
