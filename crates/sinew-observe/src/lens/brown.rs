//! Brown–Conrady distortion: a radial polynomial and decentring (OpenCV's with four or five coefficients).
//!
//! ```text
//! x_d = x g(r²) + 2 p1 x y + p2 (r² + 2 x²)       g(s) = 1 + k1 s + k2 s² + k3 s³
//! y_d = y g(r²) + 2 p2 x y + p1 (r² + 2 y²)
//! ```
//!
//! Its domain ends where r ↦ r g(r²) stops growing, at the first zero of `1 + 3 k1 s + 5 k2 s² + 7 k3 s³`. D. C. Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32 (1966).

use super::polynomial::{positive_up_to, value};
use super::{Distort, DistortionModel, Image};
use sinew_core::lanes::Real;

/// Coefficients of Brown–Conrady distortion (all zero: none).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Brown {
    /// Radial coefficient of r².
    pub k1: f64,
    /// Radial coefficient of r⁴.
    pub k2: f64,
    /// First tangential coefficient.
    pub p1: f64,
    /// Second tangential coefficient.
    pub p2: f64,
    /// Radial coefficient of r⁶.
    pub k3: f64,
}

impl Brown {
    /// Where a single point is shown, with the derivative.
    pub(super) fn at_one_point(&self, [x, y]: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let Self { k1, k2, p1, p2, k3 } = *self;
        let s = x * x + y * y;
        let g = 1.0 + s * (k1 + s * (k2 + s * k3));
        let at = [x * g + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x), y * g + 2.0 * p2 * x * y + p1 * (s + 2.0 * y * y)];
        let slope = 2.0 * (k1 + s * (2.0 * k2 + s * 3.0 * k3));
        let mixed = x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
        let xx = g + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x;
        (at, [[xx, mixed], [mixed, g + y * y * slope + 2.0 * p2 * x + 6.0 * p1 * y]])
    }
}

impl DistortionModel for Brown {
    const IS_FISHEYE: bool = false;
    const COEFFICIENTS: &'static str = "4 or 5 numbers: k1, k2, p1, p2 and perhaps k3";

    fn from_coefficients(coefficients: &[f64]) -> Option<Self> {
        match *coefficients {
            [k1, k2, p1, p2] => Some(Self { k1, k2, p1, p2, k3: 0.0 }),
            [k1, k2, p1, p2, k3] => Some(Self { k1, k2, p1, p2, k3 }),
            _ => None,
        }
    }

    fn coefficients(&self) -> Vec<f64> {
        let Self { k1, k2, p1, p2, k3 } = *self;
        if k3 == 0.0 { vec![k1, k2, p1, p2] } else { vec![k1, k2, p1, p2, k3] }
    }

    fn valid_radius(&self) -> f64 {
        positive_up_to(&[1.0, 3.0 * self.k1, 5.0 * self.k2, 7.0 * self.k3]).sqrt()
    }

    fn radius_after(&self, radius: f64) -> f64 {
        radius * value(&[1.0, self.k1, self.k2, self.k3], radius * radius)
    }
}

impl Distort for Brown {
    #[inline(always)]
    fn image<V: Real, const DERIVATIVE: bool>(&self, at: [V; 2], square: V) -> Image<V> {
        let s = |x: f64| V::splat(x);
        let (k1, k2, k3) = (s(self.k1), s(self.k2), s(self.k3));
        let gain = square.fma(square.fma(square.fma(k3, k2), k1), s(1.0));
        let growth =
            if DERIVATIVE { square.fma(square.fma(s(3.0) * k3, s(2.0) * k2), k1) * s(2.0) } else { s(0.0) };
        decentred::<V, DERIVATIVE>(at, square, [gain, growth], [self.p1, self.p2])
    }
}

/// Image of a point under a radial gain g(r²), with 2 g′(r²) where derivatives are wanted, and decentring.
#[inline(always)]
pub(super) fn decentred<V: Real, const DERIVATIVE: bool>(
    [x, y]: [V; 2],
    square: V,
    [gain, growth]: [V; 2],
    [p1, p2]: [f64; 2],
) -> Image<V> {
    let s = |x: f64| V::splat(x);
    let (p1, p2) = (s(p1), s(p2));
    let tilt = y.fma(p1, x * p2) * s(2.0);
    let at = [x.fma(gain + tilt, p2 * square), y.fma(gain + tilt, p1 * square)];
    if !DERIVATIVE {
        return Image { at, derivative: [[s(0.0); 2]; 2] };
    }
    let cross = (x * y).fma(growth, y.fma(p2, x * p1) * s(2.0));
    let xx = (x * x).fma(growth, gain + tilt) + x * p2 * s(4.0);
    let yy = (y * y).fma(growth, gain + tilt) + y * p1 * s(4.0);
    Image { at, derivative: [[xx, cross], [cross, yy]] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::Lens;

    fn check_radius([k1, k2, k3]: [f64; 3], expected: f64) {
        let found = Brown { k1, k2, k3, ..Brown::default() }.valid_radius();
        assert!(found == expected || (found - expected).abs() < 1e-12, "{found} for {expected}");
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
