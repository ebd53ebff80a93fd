//! Calibrated cameras: a place, a direction, focal lengths and a lens.
//!
//! A world point `P` (metres) becomes `P_c = R P + t` in the camera frame (x right, y down, z forward), then
//!
//! ```text
//! (x, y) = (X_c / Z_c, Y_c / Z_c),   (x_d, y_d): where the lens shows (x, y)
//! u = fx x_d + cx,   v = fy y_d + cy       (pixels)
//! ```
//!
//! Points with depth `Z_c` ≤ [`MIN_DEPTH_M`] have no projection, and neither have points beyond the domain of the lens
//! ([`Lens::valid_radius`]): [`Camera::project`] says which.
//!
//! ```
//! use sinew_observe::{Camera, Projection};
//! let camera = Camera::look_at("C1", [320.0, 240.0], 400.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0])?;
//! assert_eq!(camera.project([0.0, 0.0, 1.0]), Projection::Pixel([160.0, 120.0]));
//! assert_eq!(camera.project([0.0, -9.0, 1.0]), Projection::Behind);
//! let higher = camera.project([0.0, 0.0, 1.5]).pixel().unwrap();
//! assert!(higher[1] < 120.0); // v runs downwards
//! # Ok::<(), sinew_observe::Error>(())
//! ```

use crate::Error;
use crate::cameras::lens::Lens;

/// Depth in metres at or below which a point is not seen by a camera.
pub const MIN_DEPTH_M: f64 = 0.05;

/// Focal lengths and principal point, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsics {
    /// Focal length along u.
    pub fx: f64,
    /// Focal length along v.
    pub fy: f64,
    /// Principal point, u.
    pub cx: f64,
    /// Principal point, v.
    pub cy: f64,
}

/// A calibrated camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name, as the calibration gives it.
    pub name: String,
    /// Image width and height, pixels.
    pub image_size_px: [f64; 2],
    /// Focal lengths and principal point.
    pub intrinsics: Intrinsics,
    /// The lens.
    pub lens: Lens,
    /// Rotation, camera from world, rows first.
    pub rotation: [[f64; 3]; 3],
    /// Translation, camera from world, metres.
    pub translation: [f64; 3],
}

/// Where a point of the world appears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// At this pixel, inside the image or not.
    Pixel([f64; 2]),
    /// Nowhere: not in front of the camera by more than [`MIN_DEPTH_M`].
    Behind,
    /// Nowhere: beyond the domain of the lens.
    BeyondLens,
}

impl Projection {
    /// The pixel, if there is one.
    #[must_use]
    pub const fn pixel(self) -> Option<[f64; 2]> {
        match self {
            Self::Pixel(pixel) => Some(pixel),
            Self::Behind | Self::BeyondLens => None,
        }
    }
}

/// Deviation of `R Rᵀ` from the identity that [`Camera::validate`] accepts.
const ORTHONORMAL: f64 = 1e-6;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Camera {
    /// A virtual camera without distortion at `centre` that looks at `target` (world, metres, z up), its image upright.
    ///
    /// # Errors
    /// A view straight up or down has no upright image; numbers that are not finite, sizes that are not positive.
    pub fn look_at(
        name: &str,
        image_size_px: [f64; 2],
        focal_px: f64,
        centre: [f64; 3],
        target: [f64; 3],
    ) -> Result<Self, Error> {
        let unit = |v: [f64; 3]| {
            let norm = dot(v, v).sqrt();
            (norm > 1e-9).then(|| v.map(|x| x / norm)).ok_or_else(|| Error::NoView { camera: name.into() })
        };
        let forward = unit([0, 1, 2].map(|k: usize| target[k] - centre[k]))?;
        let right = unit(cross(forward, [0.0, 0.0, 1.0]))?;
        let rotation = [right, cross(forward, right), forward];
        let [width, height] = image_size_px;
        let camera = Self {
            name: name.into(),
            image_size_px,
            intrinsics: Intrinsics { fx: focal_px, fy: focal_px, cx: 0.5 * width, cy: 0.5 * height },
            lens: Lens::default(),
            rotation,
            translation: rotation.map(|row| -dot(row, centre)),
        };
        camera.validate()?;
        Ok(camera)
    }

    /// Checks what every other function takes for granted.
    ///
    /// # Errors
    /// [`Error`] names the camera and the first number at fault.
    pub fn validate(&self) -> Result<(), Error> {
        let Intrinsics { fx, fy, cx, cy } = self.intrinsics;
        for (field, value) in
            [("fx", fx), ("fy", fy), ("width", self.image_size_px[0]), ("height", self.image_size_px[1])]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::NotPositive { camera: self.name.clone(), field, value });
            }
        }
        let (centre, lens) = ([cx, cy], self.lens.coefficients());
        let pose = self.translation.iter().chain(self.rotation.iter().flatten());
        if !centre.iter().chain(&lens).chain(pose).all(|x| x.is_finite()) {
            return Err(Error::NotFinite { camera: self.name.clone() });
        }
        let [a, b, c] = self.rotation;
        let mut deviation = 0.0_f64;
        for (i, row) in self.rotation.iter().enumerate() {
            for (j, other) in self.rotation.iter().enumerate() {
                deviation = deviation.max((dot(*row, *other) - f64::from(u8::from(i == j))).abs());
            }
        }
        if deviation > ORTHONORMAL {
            return Err(Error::NotRotation { camera: self.name.clone(), deviation });
        }
        if dot(a, cross(b, c)) < 0.0 {
            return Err(Error::MirrorImage { camera: self.name.clone() });
        }
        Ok(())
    }

    /// The same camera in a world that is turned about its origin: `new_from_old · P` has the pixel that P had.
    #[must_use]
    pub fn turned(&self, new_from_old: [[f64; 3]; 3]) -> Self {
        let rotation = self.rotation.map(|row| new_from_old.map(|axis| dot(row, axis)));
        Self { rotation, ..self.clone() }
    }

    /// The same camera with its images resized: every pixel is `scale` times what it was.
    #[must_use]
    pub fn resized(&self, scale: f64) -> Self {
        let Intrinsics { fx, fy, cx, cy } = self.intrinsics;
        let intrinsics = Intrinsics { fx: scale * fx, fy: scale * fy, cx: scale * cx, cy: scale * cy };
        Self { image_size_px: self.image_size_px.map(|size| scale * size), intrinsics, ..self.clone() }
    }

    /// Centre of projection in the world, `−Rᵀ t`.
    #[must_use]
    pub fn centre(&self) -> [f64; 3] {
        [0, 1, 2].map(|k: usize| -(0..3).map(|i| self.rotation[i][k] * self.translation[i]).sum::<f64>())
    }

    /// A world point in the frame of the camera.
    #[must_use]
    pub fn point_in_camera(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i: usize| dot(self.rotation[i], point) + self.translation[i])
    }

    /// Pixel of a world point.
    #[must_use]
    pub fn project(&self, point: [f64; 3]) -> Projection {
        let [x, y, z] = self.point_in_camera(point);
        if z.is_nan() || z <= MIN_DEPTH_M {
            return Projection::Behind;
        }
        let shown = self.lens.distorted([x / z, y / z]);
        shown.map_or(Projection::BeyondLens, |at| Projection::Pixel(self.pixel_from_normalised(at)))
    }

    /// Pixel of a world point in the same camera with a perfect lens; `None` behind it.
    #[must_use]
    pub fn project_ideal(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let [x, y, z] = self.point_in_camera(point);
        (z > MIN_DEPTH_M).then(|| self.pixel_from_normalised([x / z, y / z]))
    }

    /// Pixel of a world point and its derivative by the point (rows u, v; pixels per metre), where there is a pixel.
    #[must_use]
    pub fn project_with_jacobian(&self, point: [f64; 3]) -> Option<([f64; 2], [[f64; 3]; 2])> {
        let [x, y, z] = self.point_in_camera(point);
        if z.is_nan() || z <= MIN_DEPTH_M {
            return None;
        }
        let ideal = [x / z, y / z];
        let (shown, [du, dv]) = self.lens.distorted_with_derivative(ideal)?;
        let [r0, r1, r2] = self.rotation;
        let before_lens = [0, 1, 2].map(|k: usize| [(r0[k] - ideal[0] * r2[k]) / z, (r1[k] - ideal[1] * r2[k]) / z]);
        let Intrinsics { fx, fy, .. } = self.intrinsics;
        let row = |f: f64, d: [f64; 2]| before_lens.map(|[a, b]| f * (d[0] * a + d[1] * b));
        Some((self.pixel_from_normalised(shown), [row(fx, du), row(fy, dv)]))
    }

    /// Pixel that a perfect lens would have shown for an observed pixel.
    ///
    /// # Errors
    /// [`Error::BeyondLens`] where the lens shows no ray.
    pub fn undistort(&self, pixel: [f64; 2]) -> Result<[f64; 2], Error> {
        let observed = self.normalised_from_pixel(pixel);
        let ideal =
            self.lens.undistorted(observed).ok_or_else(|| Error::BeyondLens { camera: self.name.clone(), pixel })?;
        Ok(self.pixel_from_normalised(ideal))
    }

    /// `(fx x + cx, fy y + cy)`.
    #[must_use]
    pub fn pixel_from_normalised(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Intrinsics { fx, fy, cx, cy } = self.intrinsics;
        [fx * x + cx, fy * y + cy]
    }

    /// `((u − cx)/fx, (v − cy)/fy)`.
    #[must_use]
    pub fn normalised_from_pixel(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let Intrinsics { fx, fy, cx, cy } = self.intrinsics;
        [(u - cx) / fx, (v - cy) / fy]
    }

    /// Rows of the 3 × 4 matrix `K [R | t]` of the camera with a perfect lens.
    #[must_use]
    pub fn matrix(&self) -> [[f64; 4]; 3] {
        let Intrinsics { fx, fy, cx, cy } = self.intrinsics;
        let [a, b, c] = [0, 1, 2].map(|i: usize| {
            let [x, y, z] = self.rotation[i];
            [x, y, z, self.translation[i]]
        });
        [0, 1, 2].map(|row: usize| match row {
            0 => [0, 1, 2, 3].map(|k: usize| fx * a[k] + cx * c[k]),
            1 => [0, 1, 2, 3].map(|k: usize| fy * b[k] + cy * c[k]),
            _ => c,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at("C1", [320.0, 240.0], 400.0, [3.0, -2.0, 2.2], [0.0, 0.0, 1.0]).unwrap()
    }

    #[test]
    fn the_centre_is_where_it_was_put_and_the_target_is_in_the_middle() {
        let camera = camera();
        assert!(camera.centre().iter().zip([3.0, -2.0, 2.2]).all(|(a, b)| (a - b).abs() < 1e-14));
        let [u, v] = camera.project([0.0, 0.0, 1.0]).pixel().unwrap();
        assert!((u - 160.0).abs() < 1e-12 && (v - 120.0).abs() < 1e-12);
        let right = camera.project([0.1, 0.15, 1.0]).pixel().unwrap();
        assert!(right[0] > 160.0 && (right[1] - 120.0).abs() < 1e-9, "{right:?}");
    }

    /// Projection (K8): the camera of Choo & Fleet, `d = ((X−Xc)/(Y−Yc), (Z−Zc)/(Y−Yc))`, is the general one with f = 1 and v negated.
    #[test]
    fn the_marker_camera_is_a_special_case() {
        let centre = [0.2, -4.8, 1.1];
        let rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
        let camera = Camera {
            name: "CF".into(),
            image_size_px: [2.0, 2.0],
            intrinsics: Intrinsics { fx: 1.0, fy: 1.0, cx: 0.0, cy: 0.0 },
            lens: Lens::default(),
            rotation,
            translation: rotation.map(|row| -dot(row, centre)),
        };
        camera.validate().unwrap();
        let p = [0.5, 0.3, 1.7];
        let [u, v] = camera.project(p).pixel().unwrap();
        let depth = p[1] - centre[1];
        assert!((u - (p[0] - centre[0]) / depth).abs() < 1e-15);
        assert!((-v - (p[2] - centre[2]) / depth).abs() < 1e-15);
        let (_, [du, dv]) = camera.project_with_jacobian(p).unwrap();
        for (found, expected) in du.iter().zip([1.0, -u, 0.0]).chain(dv.iter().zip([0.0, -v, -1.0])) {
            assert!((found - expected / depth).abs() < 1e-15);
        }
    }

    #[test]
    fn a_resized_camera_sees_the_same_at_other_pixels() {
        let lens = crate::cameras::lens::Brown { k1: -0.1, p1: 1e-3, ..Default::default() };
        let camera = Camera { lens: lens.into(), ..camera() };
        let half = camera.resized(0.5);
        let [[u, v], [a, b]] = [&camera, &half].map(|c| c.project([0.4, 0.3, 1.6]).pixel().unwrap());
        assert!((u - 2.0 * a).abs() < 1e-12 && (v - 2.0 * b).abs() < 1e-12);
        assert_eq!(half.image_size_px, [160.0, 120.0]);
    }

    #[test]
    fn what_is_not_in_front_has_no_pixel() {
        let camera = camera();
        let centre = camera.centre();
        let ahead = |m: f64| [0, 1, 2].map(|k: usize| centre[k] + m * camera.rotation[2][k]);
        assert_eq!(camera.project(ahead(0.9 * MIN_DEPTH_M)), Projection::Behind);
        assert_eq!(camera.project(ahead(-1.0)), Projection::Behind);
        assert!(camera.project(ahead(1.1 * MIN_DEPTH_M)).pixel().is_some());
        assert_eq!(camera.project([f64::NAN; 3]), Projection::Behind);
    }

    #[test]
    fn faults_are_named() {
        let check = |change: fn(&mut Camera), expected: &str| {
            let mut camera = camera();
            change(&mut camera);
            assert_eq!(camera.validate().unwrap_err().to_string(), expected);
        };
        check(|c| c.intrinsics.fx = 0.0, "C1: fx = 0; must be positive");
        check(|c| c.intrinsics.fy = f64::NAN, "C1: fy = NaN; must be positive");
        check(|c| c.translation[1] = f64::INFINITY, "C1: a number of the calibration is not finite");
        check(|c| c.rotation[0] = [2.0, 0.0, 0.0], "C1: R'R differs from identity by 3");
        check(
            |c| c.rotation[0] = c.rotation[0].map(|x| -x),
            "C1: R is a mirror image (determinant -1); axes are left-handed",
        );
        let above = Camera::look_at("C1", [2.0, 2.0], 1.0, [0.0, 0.0, 3.0], [0.0; 3]);
        assert_eq!(above.unwrap_err(), Error::NoView { camera: "C1".into() });
    }
}
