//! How a camera may differ from its calibration, in ten numbers.
//!
//! With a point x in the frame of the calibrated camera, the camera is
//!
//! ```text
//! x' = exp([ω]) x + t,   f' = f e^φ,   (cx', cy') = (cx + a fx, cy + b fy),   k1' = k1 + κ
//! ```
//!
//! ω and t are radians and metres in the frame of the camera, φ a share, (a, b) units of the focal length (radians near the axis), κ the coefficient of r³ in where the lens shows a ray.
//! All are the same for images of any size.

use crate::cameras::camera::{Camera, Intrinsics};
use crate::cameras::lens::Lens;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Numbers of an error.
pub const NUMBERS: usize = 10;

/// Their names, in order.
pub const NAMES: [&str; NUMBERS] = [
    "rotation_x_rad",
    "rotation_y_rad",
    "rotation_z_rad",
    "translation_x_m",
    "translation_y_m",
    "translation_z_m",
    "log_focal_length",
    "principal_point_u",
    "principal_point_v",
    "k1",
];

/// Where the numbers of the principal point begin: an offset of all pixels, in units of the focal length.
pub const PRINCIPAL_POINT: usize = 7;

/// The camera that differs from its calibration by an error.
#[must_use]
pub fn with_error(camera: &Camera, error: &[f64; NUMBERS]) -> Camera {
    let [wx, wy, wz, tx, ty, tz, log_focal, a, b, k1] = *error;
    let turn = Rotation3::from_scaled_axis(Vector3::new(wx, wy, wz)).into_inner();
    let rotation = turn * Matrix3::from_fn(|i, j| camera.rotation[i][j]);
    let translation = turn * Vector3::from(camera.translation) + Vector3::new(tx, ty, tz);
    let Intrinsics { fx, fy, cx, cy } = camera.intrinsics;
    let focal = log_focal.exp();
    let mut coefficients = camera.lens.coefficients();
    if let Some(first) = coefficients.first_mut() {
        *first += k1;
    }
    Camera {
        intrinsics: Intrinsics { fx: focal * fx, fy: focal * fy, cx: cx + a * fx, cy: cy + b * fy },
        lens: Lens::from_coefficients(camera.lens.is_fisheye(), &coefficients).unwrap_or(camera.lens),
        rotation: [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| rotation[(i, j)])),
        translation: translation.into(),
        ..camera.clone()
    }
}

/// Pixel of a world point and its derivatives, rows u and v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelDerivatives {
    /// The pixel.
    pub pixel: [f64; 2],
    /// By the point, pixels a metre.
    pub by_point: [[f64; 3]; 2],
    /// By the error of the camera at zero.
    pub by_error: [[f64; NUMBERS]; 2],
}

/// Pixel and derivatives, where there is a pixel. The derivative by κ leaves the denominator of a rational lens out.
#[must_use]
pub fn derivatives(camera: &Camera, point: [f64; 3]) -> Option<PixelDerivatives> {
    let (pixel, by_point) = camera.project_with_jacobian(point)?;
    let [x, y, z] = camera.point_in_camera(point);
    let Intrinsics { fx, fy, cx, cy } = camera.intrinsics;
    let (ideal_x, ideal_y) = (x / z, y / z);
    let square = ideal_x * ideal_x + ideal_y * ideal_y;
    let radial = if camera.lens.is_fisheye() {
        let radius = square.sqrt();
        if radius > 0.0 { radius.atan().powi(3) / radius } else { 0.0 }
    } else {
        square
    };
    let row = |axis: usize| {
        // By the point in the frame of the camera: ∂pixel/∂x = (∂pixel/∂P) Rᵀ.
        let [a, b, c] = camera.rotation.map(|row| (0..3).map(|k| by_point[axis][k] * row[k]).sum::<f64>());
        let (focal, from_centre, ideal) = [(fx, pixel[0] - cx, ideal_x), (fy, pixel[1] - cy, ideal_y)][axis];
        let shift = [[fx, 0.0], [0.0, fy]][axis];
        [c * y - b * z, a * z - c * x, b * x - a * y, a, b, c, from_centre, shift[0], shift[1], focal * ideal * radial]
    };
    Some(PixelDerivatives { pixel, by_point, by_error: [row(0), row(1)] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::lens::{Brown, Fisheye};

    #[test]
    fn derivatives_agree_with_differences() {
        let plain = Camera::look_at("C1", [1280.0, 960.0], 900.0, [3.0, -2.0, 2.2], [0.0, 0.0, 1.0]).unwrap();
        let brown = Brown { k1: -0.1, k2: 0.03, p1: 1e-3, p2: -5e-4, k3: 0.0 };
        let fisheye = Fisheye { k: [-0.02, 0.003, 0.0, 0.0] };
        for lens in [Lens::default(), brown.into(), fisheye.into()] {
            let camera = Camera { lens, ..plain.clone() };
            for point in [[0.4, 0.9, 1.8], [-0.6, 0.2, 0.1]] {
                let PixelDerivatives { pixel, by_point, by_error } = derivatives(&camera, point).unwrap();
                assert_eq!(camera.project(point).pixel(), Some(pixel));
                let step = 1e-5;
                for number in 0..NUMBERS {
                    let shown = |by: f64| {
                        let mut error = [0.0; NUMBERS];
                        error[number] = by;
                        with_error(&camera, &error).project(point).pixel().unwrap()
                    };
                    let (high, low) = (shown(step), shown(-step));
                    for axis in 0..2 {
                        let difference = (high[axis] - low[axis]) / (2.0 * step);
                        let found = by_error[axis][number];
                        assert!(
                            (found - difference).abs() < 1e-5 * (1.0 + difference.abs()),
                            "{}: {found} for {difference}",
                            NAMES[number]
                        );
                    }
                }
                assert_eq!(camera.project_with_jacobian(point).unwrap().1, by_point);
            }
        }
    }

    #[test]
    fn an_error_is_the_same_for_images_of_any_size_and_none_changes_nothing() {
        let camera = Camera::look_at("C1", [1280.0, 960.0], 900.0, [3.0, -2.0, 2.2], [0.0, 0.0, 1.0]).unwrap();
        let error = [0.01, -0.02, 0.005, 0.03, -0.01, 0.02, 0.004, 0.003, -0.002, 0.01];
        let [[u, v], [a, b]] = [with_error(&camera, &error), with_error(&camera.resized(0.5), &error)]
            .map(|camera| camera.project([0.4, 0.9, 1.8]).pixel().unwrap());
        assert!((u - 2.0 * a).abs() < 1e-9 && (v - 2.0 * b).abs() < 1e-9);
        with_error(&camera, &error).validate().unwrap();
        let same = with_error(&camera, &[0.0; NUMBERS]);
        assert!(same.project([0.4, 0.9, 1.8]) == camera.project([0.4, 0.9, 1.8]));
    }
}
