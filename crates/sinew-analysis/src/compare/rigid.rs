//! The rigid motion, and if requested the scale, that takes points nearest to others.
//!
//! With centred points p, q and the singular value decomposition Σ q pᵀ = U D Vᵀ, the rotation is R = U S Vᵀ with S = diag(1, 1, det U det V), the scale tr(D S) / Σ |p|² (Umeyama, IEEE PAMI 13, 1991, equations 40 to 43).

use nalgebra::{Matrix3, Vector3};

/// y = scale · rotation · x + shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    /// Scale; 1 where it is not fitted.
    pub scale: f64,
    /// Rotation.
    pub rotation: Matrix3<f64>,
    /// Shift, metres.
    pub shift: Vector3<f64>,
}

impl Similarity {
    /// What leaves points where they are.
    pub const IDENTITY: Self = Self {
        scale: 1.0,
        rotation: Matrix3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        shift: Vector3::new(0.0, 0.0, 0.0),
    };

    /// Where a point comes to.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.scale * (self.rotation * Vector3::from(point)) + self.shift).into()
    }

    /// The turn from the vertical axis, and the heading that remains, degrees: rotation = about z · tilt.
    #[must_use]
    pub fn tilt_and_heading_deg(&self) -> [f64; 2] {
        let up = self.rotation.column(2);
        let heading =
            (self.rotation[(1, 0)] - self.rotation[(0, 1)]).atan2(self.rotation[(0, 0)] + self.rotation[(1, 1)]);
        [up[2].clamp(-1.0, 1.0).acos(), heading].map(f64::to_degrees)
    }
}

/// Sums over pairs of points, from which the fit follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairSums {
    count: f64,
    from: Vector3<f64>,
    onto: Vector3<f64>,
    product: Matrix3<f64>,
    squares: [f64; 2],
}

impl PairSums {
    pub(super) const fn new() -> Self {
        let zero = Vector3::new(0.0, 0.0, 0.0);
        let product = Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        Self { count: 0.0, from: zero, onto: zero, product, squares: [0.0; 2] }
    }

    pub(super) fn add(&mut self, from: [f64; 3], onto: [f64; 3]) {
        let [from, onto] = [from, onto].map(Vector3::from);
        self.count += 1.0;
        self.from += from;
        self.onto += onto;
        self.product += onto * from.transpose();
        self.squares[0] += from.norm_squared();
        self.squares[1] += onto.norm_squared();
    }

    /// Mean of the points that others are taken onto.
    pub(super) fn middle(&self) -> Vector3<f64> {
        self.onto / self.count
    }

    pub(super) const fn count(&self) -> f64 {
        self.count
    }

    /// The fit and its mean square distance, m²; `None` of points on a line, which leave a turn open.
    pub(super) fn fit(&self, scaled: bool) -> Option<(Similarity, f64)> {
        let centred = self.product - self.onto * self.from.transpose() / self.count;
        let [from, onto] = [(self.squares[0], self.from), (self.squares[1], self.onto)]
            .map(|(square, sum)| square - sum.norm_squared() / self.count);
        let parts = centred.svd(true, true);
        let (left, right) = (parts.u?, parts.v_t?);
        let values = parts.singular_values;
        if !(self.count >= 3.0 && values[1] > 1e-9 * values[0] && values[0] > 0.0) {
            return None;
        }
        let sign = (left.determinant() * right.determinant()).signum();
        let rotation = left * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * right;
        let trace = values[0] + values[1] + sign * values[2];
        let scale = if scaled { trace / from } else { 1.0 };
        let shift = (self.onto - scale * (rotation * self.from)) / self.count;
        let square = (scale * scale).mul_add(from, onto) - 2.0 * scale * trace;
        Some((Similarity { scale, rotation, shift }, (square / self.count).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    const POINTS: [[f64; 3]; 5] =
        [[0.0, 0.1, 1.0], [0.4, 0.0, 1.5], [-0.2, 0.3, 0.2], [0.1, -0.5, 0.9], [0.7, 0.6, 0.0]];

    fn fitted(truth: &Similarity, scaled: bool) -> (Similarity, f64) {
        let mut sums = PairSums::new();
        POINTS.iter().for_each(|point| sums.add(*point, truth.apply(*point)));
        sums.fit(scaled).unwrap()
    }

    #[test]
    fn a_known_motion_is_recovered() {
        let rotation = Rotation3::from_euler_angles(0.3, -1.2, 2.5).into_inner();
        for (scale, scaled) in [(1.0, false), (1.0, true), (1.02, true)] {
            let truth = Similarity { scale, rotation, shift: Vector3::new(3.0, -2.0, 0.5) };
            let (found, square) = fitted(&truth, scaled);
            assert!((found.rotation - truth.rotation).norm() < 1e-12, "{found:?}");
            assert!((found.shift - truth.shift).norm() < 1e-12 && (found.scale - scale).abs() < 1e-12, "{found:?}");
            assert!(square < 1e-12);
        }
        // Without a scale a larger body is off by what the scale would have taken.
        let truth = Similarity { scale: 1.02, rotation, shift: Vector3::zeros() };
        assert!(fitted(&truth, false).1 > 1e-5);
    }

    #[test]
    fn a_mirror_image_becomes_no_reflection() {
        let mut sums = PairSums::new();
        POINTS.iter().for_each(|[x, y, z]| sums.add([*x, *y, *z], [-x, *y, *z]));
        let (found, square) = sums.fit(false).unwrap();
        assert!((found.rotation.determinant() - 1.0).abs() < 1e-12 && square > 1e-3);
    }

    #[test]
    fn points_on_a_line_leave_the_turn_open() {
        let mut sums = PairSums::new();
        (0..5).map(|k| [f64::from(k), 0.0, 1.0]).for_each(|point| sums.add(point, point));
        assert!(sums.fit(false).is_none());
        assert!(PairSums::new().fit(false).is_none());
    }

    #[test]
    fn tilt_and_heading_are_apart() {
        let turn = |roll: f64, yaw: f64| Similarity {
            rotation: Rotation3::from_euler_angles(roll, 0.0, yaw).into_inner(),
            ..Similarity::IDENTITY
        };
        let [tilt, heading] = turn(0.1, 1.0).tilt_and_heading_deg();
        assert!((tilt - 0.1_f64.to_degrees()).abs() < 1e-9 && (heading - 1.0_f64.to_degrees()).abs() < 1e-9);
    }
}
