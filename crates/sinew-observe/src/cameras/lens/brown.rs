//! Brown–Conrady distortion: a radial polynomial and decentring (OpenCV's with four or five coefficients).
//!
//! ```text
//! x_d = x g(r²) + 2 p1 x y + p2 (r² + 2 x²)       g(s) = 1 + k1 s + k2 s² + k3 s³
//! y_d = y g(r²) + 2 p2 x y + p1 (r² + 2 y²)
//! ```
//!
//! Its domain ends where r ↦ r g(r²) stops growing, at the first zero of `1 + 3 k1 s + 5 k2 s² + 7 k3 s³`. D. C. Brown, "Decentering distortion of lenses", Photogrammetric Engineering 32 (1966).

use super::model::{Distort, DistortionModel, Image};
use super::polynomial::{positive_up_to, value};

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
        let growth = if DERIVATIVE { square.fma(square.fma(s(3.0) * k3, s(2.0) * k2), k1) * s(2.0) } else { s(0.0) };
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
}
