//! Truncated elliptical cones, the flesh of a part, and what of their surface an eye sees edge-on.
//!
//! In the part's own frame the base is centred on the origin and the axis is +z. At height z between 0 and h the section is an ellipse of semi-axes r(z) along x and e r(z) along y, with r(z) = a₀ + k z, k = (a₁ − a₀)/h
//! and the axis ratio e, the same at both ends. The surface is S(v, z) = (r cos v, e r sin v, z).
//!
//! Seen from c, stretched along y to c' = (c_x, c_y/e, c_z), the cone is round: with ρ = |(c'_x, c'_y)| and φ its direction, a generator v lies on the occluding contour where the normal n = (cos v, sin v/e, −k) is
//! perpendicular to c − S, which is cos(v − φ) = r(c_z)/ρ. There are two of them, v = φ ± arccos(r(c_z)/ρ), where ρ > |r(c_z)|; else an end cap hides the side, or the side is seen all around.

/// A truncated elliptical cone in its own frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frustum {
    /// Height h.
    pub height: f64,
    /// Semi-axis along x at the base and at the top.
    pub radii: [f64; 2],
    /// Semi-axis along y over that along x.
    pub ratio: f64,
}

impl Frustum {
    /// Growth k of the semi-axis with height.
    #[must_use]
    pub fn slope(&self) -> f64 {
        (self.radii[1] - self.radii[0]) / self.height
    }

    /// Semi-axis along x at a height, also beyond the ends.
    #[must_use]
    pub fn radius(&self, z: f64) -> f64 {
        self.radii[0] + self.slope() * z
    }

    /// The point of the surface in direction `v` (radians from +x) at height `z`.
    #[must_use]
    pub fn surface(&self, v: f64, z: f64) -> [f64; 3] {
        let (sin, cos) = v.sin_cos();
        let r = self.radius(z);
        [r * cos, self.ratio * r * sin, z]
    }

    /// Directions of the two generators that an eye at `eye` sees edge-on, radians; `None` where there are none. The side between the first and the second, going up, faces the eye.
    #[must_use]
    pub fn contour(&self, eye: [f64; 3]) -> Option<[f64; 2]> {
        let (x, y) = (eye[0], eye[1] / self.ratio);
        let (away, towards) = (x.hypot(y), y.atan2(x));
        let opening = (self.radius(eye[2]) / away).acos();
        // Not a number where the eye is inside the round cone, or on the axis.
        (opening > 0.0 && opening < std::f64::consts::PI).then_some([towards - opening, towards + opening])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn frustum() -> impl Strategy<Value = Frustum> {
        (0.1..0.6f64, [0.02..0.2f64, 0.02..0.2f64], 0.5..1.5f64).prop_map(|(height, radii, ratio)| Frustum {
            height,
            radii,
            ratio,
        })
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| a[k] * b[k]).sum()
    }

    proptest! {
        /// The normal is that of the surface (by differences), perpendicular to the line of sight, and the whole solid lies on one side of the plane through the eye and a generator.
        #[test]
        fn generators_of_the_contour_are_seen_edge_on(f in frustum(), eye in [-6.0..6.0f64, -6.0..6.0f64, -3.0..3.0f64]) {
            let Some(contour) = f.contour(eye) else {
                let inside = eye[0].hypot(eye[1] / f.ratio) <= f.radius(eye[2]).abs();
                prop_assert!(inside);
                return Ok(());
            };
            for v in contour {
                let n = [v.cos(), v.sin() / f.ratio, -f.slope()];
                let p = f.surface(v, 0.3 * f.height);
                for (dv, dz) in [(1e-6, 0.0), (0.0, 1e-6)] {
                    let [q, o] = [1.0, -1.0].map(|s| f.surface(v + s * dv, 0.3 * f.height + s * dz));
                    let along = [0, 1, 2].map(|k| (q[k] - o[k]) / 2e-6);
                    prop_assert!(dot(n, along).abs() < 1e-7, "not the normal: {}", dot(n, along));
                }
                let sight = [0, 1, 2].map(|k| eye[k] - p[k]);
                prop_assert!(dot(n, sight).abs() < 1e-9, "{}", dot(n, sight));
                for i in 0..24 {
                    for z in [0.0, 0.5 * f.height, f.height] {
                        let q = f.surface(f64::from(i) * std::f64::consts::TAU / 24.0, z);
                        prop_assert!(dot(n, [0, 1, 2].map(|k| q[k] - p[k])) < 1e-12);
                    }
                }
            }
            // Halfway between them the side faces the eye.
            let v = 0.5 * (contour[0] + contour[1]);
            let p = f.surface(v, 0.5 * f.height);
            let n = [v.cos(), v.sin() / f.ratio, -f.slope()];
            prop_assert!(contour[0] < contour[1] && dot(n, [0, 1, 2].map(|k| eye[k] - p[k])) > 0.0);
        }
    }

    #[test]
    fn from_the_axis_no_generator_is_seen_edge_on() {
        let f = Frustum { height: 0.5, radii: [0.1, 0.05], ratio: 0.8 };
        for eye in [[0.0, 0.0, 3.0], [0.0, 0.0, -3.0], [0.01, 0.02, 0.2]] {
            assert_eq!(f.contour(eye), None, "{eye:?}");
        }
    }
}
