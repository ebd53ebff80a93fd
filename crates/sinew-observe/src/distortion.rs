//! Brown's lens distortion: forwards, its derivative, and backwards inside the radius where that is possible.
//!
//! ```text
//! x_d = x g(r²) + 2 p1 x y + p2 (r² + 2 x²)       g(s) = 1 + k1 s + k2 s² + k3 s³
//! y_d = y g(r²) + 2 p2 x y + p1 (r² + 2 y²)
//! ```
//!
//! Radially r ↦ r g(r²) grows only up to the first zero of `1 + 3 k1 s + 5 k2 s² + 7 k3 s³`; beyond it two rays share a pixel and fitted coefficients mean nothing.
//! That radius is the limit of both directions.

use crate::camera::Distortion;

/// Steps of bisection, enough for a double's 53 bits.
const BISECTIONS: usize = 200;
const NEWTON_STEPS: usize = 50;
/// Remaining error of the inverse, in normalised coordinates (1e-12 is 2e-9 px at f = 1700 px).
const TOLERANCE: f64 = 1e-13;

impl Distortion {
    /// Normalised image position after the lens.
    #[must_use]
    pub fn distorted(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let s = x * x + y * y;
        let g = self.gain(s);
        [
            x * g + 2.0 * self.p1 * x * y + self.p2 * (s + 2.0 * x * x),
            y * g + 2.0 * self.p2 * x * y + self.p1 * (s + 2.0 * y * y),
        ]
    }

    /// Derivative of [`Distortion::distorted`], rows x_d, y_d.
    #[must_use]
    pub fn derivative(&self, [x, y]: [f64; 2]) -> [[f64; 2]; 2] {
        let s = x * x + y * y;
        let g = self.gain(s);
        let slope = 2.0 * (self.k1 + s * (2.0 * self.k2 + s * 3.0 * self.k3));
        let mixed = x * y * slope + 2.0 * self.p1 * x + 2.0 * self.p2 * y;
        [
            [g + x * x * slope + 2.0 * self.p1 * y + 6.0 * self.p2 * x, mixed],
            [mixed, g + y * y * slope + 2.0 * self.p2 * x + 6.0 * self.p1 * y],
        ]
    }

    /// Normalised position before the lens, where it exists inside the valid radius.
    #[must_use]
    pub fn undistorted(&self, observed: [f64; 2]) -> Option<[f64; 2]> {
        let radius = observed[0].hypot(observed[1]);
        if !radius.is_finite() {
            return None;
        }
        if *self == Self::default() || radius == 0.0 && self.p1 == 0.0 && self.p2 == 0.0 {
            return Some(observed);
        }
        let limit = self.valid_radius();
        let start = self.radius_before(radius, limit).unwrap_or(limit.min(radius));
        let mut p = if radius > 0.0 { observed.map(|x| x * start / radius) } else { observed };
        for _ in 0..NEWTON_STEPS {
            let q = self.distorted(p);
            let error = [observed[0] - q[0], observed[1] - q[1]];
            if error[0].hypot(error[1]) <= TOLERANCE * (1.0 + radius) {
                return (p[0].hypot(p[1]) <= limit).then_some(p);
            }
            let [[a, b], [c, d]] = self.derivative(p);
            let determinant = a * d - b * c;
            if determinant.is_nan() || determinant.abs() <= f64::MIN_POSITIVE {
                return None;
            }
            p[0] += (d * error[0] - b * error[1]) / determinant;
            p[1] += (a * error[1] - c * error[0]) / determinant;
        }
        None
    }

    /// Largest radius, in normalised coordinates before the lens, up to which the radial polynomial grows; infinite where it always does.
    #[must_use]
    pub fn valid_radius(&self) -> f64 {
        let (b, c, d) = (3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3);
        if b >= 0.0 && c >= 0.0 && d >= 0.0 {
            return f64::INFINITY;
        }
        let slope = |s: f64| 1.0 + s * (b + s * (c + s * d));
        let leading = [d, c, b].into_iter().find(|x| *x != 0.0).unwrap_or(1.0).abs();
        let bound = 1.0 + [1.0, b.abs(), c.abs(), d.abs()].into_iter().fold(0.0, f64::max) / leading;
        // Between its turning points the slope is monotone, so a sign change is a single zero.
        let mut previous = 0.0;
        for end in turning_points(3.0 * d, 2.0 * c, b).into_iter().chain([bound]) {
            if end > previous && end <= bound {
                if slope(end) < 0.0 {
                    return bisect(slope, previous, end).sqrt();
                }
                previous = end;
            }
        }
        f64::INFINITY
    }

    fn gain(&self, s: f64) -> f64 {
        1.0 + s * (self.k1 + s * (self.k2 + s * self.k3))
    }

    /// Radius before the lens by the radial part alone, if `radius` is reached below the limit.
    fn radius_before(&self, radius: f64, limit: f64) -> Option<f64> {
        let after = |r: f64| r * self.gain(r * r);
        let mut high = radius.min(limit);
        while after(high) < radius {
            if high >= limit || high > 1e6 * (1.0 + radius) {
                return None;
            }
            high = (2.0 * high).min(limit);
        }
        Some(bisect(|r| radius - after(r), 0.0, high))
    }
}

/// Real zeros of a s² + b s + c, rising.
fn turning_points(a: f64, b: f64, c: f64) -> Vec<f64> {
    if a == 0.0 {
        return if b == 0.0 { vec![] } else { vec![-c / b] };
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant.is_nan() || discriminant <= 0.0 {
        return vec![];
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let mut zeros = vec![q / a];
    if q != 0.0 {
        zeros.push(c / q);
    }
    zeros.sort_by(f64::total_cmp);
    zeros
}

/// Last point in [low, high] at which `f`, positive at `low` and falling, is not yet negative.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if f(middle) < 0.0 { high = middle } else { low = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_radius([k1, k2, k3]: [f64; 3], expected: f64) {
        let found = Distortion { k1, k2, k3, ..Distortion::default() }.valid_radius();
        assert!(found == expected || (found - expected).abs() < 1e-12, "{found} for {expected}");
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
            // Close to the limit the two axes cannot be told from each other's.
            ([-0.3, 0.0, 0.0], 1.053),
        ] {
            let lens = Distortion { k1, k2, k3, p1: -1e-5, p2: 5e-6 };
            assert!(radius < lens.valid_radius());
            for angle in [0.3_f64, 0.785, 2.0, 4.5] {
                let before = [radius * angle.cos(), radius * angle.sin()];
                let found = lens.undistorted(lens.distorted(before)).expect("inside the valid radius");
                assert!((0..2).all(|k| (found[k] - before[k]).abs() < 1e-6), "{lens:?}: {found:?} for {before:?}");
            }
        }
    }

    #[test]
    fn turning_points_are_the_zeros_of_the_quadratic() {
        for (abc, zeros) in [
            ([1.0, -3.0, 2.0], vec![1.0, 2.0]),
            ([2.0, 4.0, -6.0], vec![-3.0, 1.0]),
            ([-1.0, 0.0, 4.0], vec![-2.0, 2.0]),
            ([1.0, 0.0, 1.0], vec![]),
            ([1.0, -2.0, 1.0], vec![]),
            ([0.0, 2.0, -5.0], vec![2.5]),
            ([0.0, 0.0, 1.0], vec![]),
            ([1.0, f64::NAN, 1.0], vec![]),
        ] {
            let [a, b, c] = abc;
            assert_eq!(turning_points(a, b, c), zeros, "{abc:?}");
        }
    }

    #[test]
    fn the_polynomial_grows_up_to_its_valid_radius() {
        check_radius([0.0; 3], f64::INFINITY);
        check_radius([0.1, 0.0, 0.0], f64::INFINITY);
        check_radius([-0.3, 0.0, 0.0], (1.0_f64 / 0.9).sqrt());
        check_radius([-0.3, 0.2, 0.0], f64::INFINITY);
        // 1 − 1.2 s + 0.35 s² falls to zero at s = 2 (and rises again later).
        check_radius([-0.4, 0.07, 0.0], ((1.2 - 0.04_f64.sqrt()) / 0.7).sqrt());
        check_radius([0.0, 0.0, -1.0 / 7.0], 1.0);
    }

    #[test]
    fn outside_the_valid_radius_there_is_no_inverse() {
        let barrel = Distortion { k1: -0.3, ..Distortion::default() };
        let limit = barrel.valid_radius();
        let [edge, _] = barrel.distorted([limit, 0.0]);
        assert!(barrel.undistorted([0.999 * edge, 0.0]).is_some());
        assert_eq!(barrel.undistorted([1.001 * edge, 0.0]), None);
        assert_eq!(barrel.undistorted([f64::NAN, 0.0]), None);
        assert_eq!(barrel.undistorted([1e300, 0.0]), None);
    }
}
