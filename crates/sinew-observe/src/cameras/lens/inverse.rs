//! Undoing a lens: the ray that is shown at a place, by Newton's method. It starts from the solution of the radial part.

use super::Lens;
use super::polynomial::bisect;

const NEWTON_STEPS: usize = 50;
/// Remaining error, in normalised coordinates (1e-12 is 2e-9 px at f = 1700 px).
const TOLERANCE: f64 = 1e-13;
/// Radius, in multiples of the observed one, beyond which a ray is not looked for.
const FURTHEST: f64 = 1e6;

impl Lens {
    /// Normalised position before the lens, where it exists inside the domain.
    #[must_use]
    pub fn undistorted(&self, observed: [f64; 2]) -> Option<[f64; 2]> {
        let radius = observed[0].hypot(observed[1]);
        if !radius.is_finite() {
            return None;
        }
        if self.is_perfect() {
            return Some(observed);
        }
        let limit = self.valid_radius();
        let start = self.radius_before(radius).unwrap_or(limit.min(radius));
        let mut p = if radius > 0.0 { observed.map(|x| x * start / radius) } else { observed };
        for _ in 0..NEWTON_STEPS {
            let (q, [[a, b], [c, d]]) = self.extended::<true>(p);
            let error = [observed[0] - q[0], observed[1] - q[1]];
            if error[0].hypot(error[1]) <= TOLERANCE * (1.0 + radius) {
                return (p[0].hypot(p[1]) <= limit).then_some(p);
            }
            let determinant = a * d - b * c;
            if determinant.is_nan() || determinant.abs() <= f64::MIN_POSITIVE {
                return None;
            }
            p[0] += (d * error[0] - b * error[1]) / determinant;
            p[1] += (a * error[1] - c * error[0]) / determinant;
        }
        None
    }

    /// Radius before the lens by the radial part alone, if `radius` is reached inside the domain.
    fn radius_before(&self, radius: f64) -> Option<f64> {
        let limit = self.valid_radius();
        let after = |r: f64| self.distortion.radius_after(r);
        let mut high = radius.min(limit);
        while after(high) < radius {
            if high >= limit || high > FURTHEST * (1.0 + radius) {
                return None;
            }
            high = (2.0 * high).min(limit);
        }
        Some(bisect(|r| radius - after(r), 0.0, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::lens::{Brown, Fisheye};

    #[test]
    fn outside_the_valid_radius_there_is_no_inverse() {
        let barrel = Lens::from(Brown { k1: -0.3, ..Brown::default() });
        let [edge, _] = barrel.distorted([barrel.valid_radius(), 0.0]).expect("inside");
        assert!(barrel.undistorted([0.999 * edge, 0.0]).is_some());
        assert_eq!(barrel.undistorted([1.001 * edge, 0.0]), None);
        assert_eq!(barrel.undistorted([f64::NAN, 0.0]), None);
        assert_eq!(barrel.undistorted([1e300, 0.0]), None);
    }

    #[test]
    fn a_fisheye_lens_is_undone_up_to_its_right_angle() {
        let lens = Lens::from(Fisheye::default());
        for angle in [0.0, 1e-9, 0.3, 1.0, 1.5, 1.55] {
            let before = [0.6 * f64::tan(angle), -0.8 * f64::tan(angle)];
            let found = lens.undistorted([0.6 * angle, -0.8 * angle]).expect("in front");
            assert!(
                (0..2).all(|k| (found[k] - before[k]).abs() <= 1e-9 * (1.0 + before[k].abs())),
                "{found:?} {before:?}"
            );
        }
        assert_eq!(lens.undistorted([1.6, 0.0]), None);
        assert_eq!(lens.undistorted([-40.0, 3.0]), None);
    }

    /// Lenses so strong that Newton steps from the observed radius go astray: they start from the radial part's own solution.
    #[test]
    fn strong_lenses_are_undone_up_to_their_limit() {
        for ([k1, k2, k3], radius) in [
            ([-0.000_456, 0.297_074, -0.090_312], 1.451_536),
            ([0.514_874, 0.233_651, -0.030_496], 1.196_754),
            ([0.355_026, 0.039_149, -0.129_805], 1.107_011),
            ([-0.403_121, 0.533_08, -0.069_459], 1.427_714),
            ([0.362_259, 0.233_022, -0.139_293], 1.125_255),
            ([-0.01, 0.0, 0.0], 3.2),
            // Close to the limit the images of the two axes nearly coincide.
            ([-0.3, 0.0, 0.0], 1.053),
        ] {
            let lens = Lens::from(Brown { k1, k2, k3, p1: -1e-5, p2: 5e-6 });
            assert!(radius < lens.valid_radius());
            for angle in [0.3_f64, 0.785, 2.0, 4.5] {
                let before = [radius * angle.cos(), radius * angle.sin()];
                let after = lens.distorted(before).expect("inside the valid radius");
                let found = lens.undistorted(after).expect("inside the valid radius");
                assert!((0..2).all(|k| (found[k] - before[k]).abs() < 1e-6), "{lens:?}: {found:?} for {before:?}");
            }
        }
    }
}
