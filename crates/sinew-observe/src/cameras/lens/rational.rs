//! Rational distortion: a quotient of two radial polynomials and decentring (OpenCV's with eight coefficients).
//!
//! ```text
//! x_d = x g(r²) + 2 p1 x y + p2 (r² + 2 x²)       g(s) = (1 + k1 s + k2 s² + k3 s³) / (1 + k4 s + k5 s² + k6 s³) = N(s) / D(s)
//! y_d = y g(r²) + 2 p2 x y + p1 (r² + 2 y²)
//! ```
//!
//! Its domain ends where r ↦ r g(r²) stops growing, at the first zero of `N D + 2 s (N′ D − N D′)`, or before, where D falls to [`LEAST_DENOMINATOR`].
//! D. Claus and A. W. Fitzgibbon, "A rational function lens distortion model for general cameras", CVPR 2005, in OpenCV's form.

use super::brown::decentred;
use super::model::{Distort, DistortionModel, Image};
use super::polynomial::{derivative, positive_up_to, product, value};

use sinew_core::lanes::Real;

/// Denominator at and below which the quotient has no meaning.
const LEAST_DENOMINATOR: f64 = 1e-6;

/// Coefficients of rational distortion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rational {
    /// k1, k2 and k3: of r², r⁴ and r⁶ in the numerator.
    pub numerator: [f64; 3],
    /// k4, k5 and k6: of r², r⁴ and r⁶ in the denominator.
    pub denominator: [f64; 3],
    /// First tangential coefficient.
    pub p1: f64,
    /// Second tangential coefficient.
    pub p2: f64,
}

impl Rational {
    /// N and D.
    fn polynomials(&self) -> [[f64; 4]; 2] {
        [self.numerator, self.denominator].map(|[a, b, c]| [1.0, a, b, c])
    }
}

impl DistortionModel for Rational {
    const IS_FISHEYE: bool = false;
    const COEFFICIENTS: &'static str = "8: k1, k2, p1, p2, k3, k4, k5, k6";

    fn from_coefficients(coefficients: &[f64]) -> Option<Self> {
        let [k1, k2, p1, p2, k3, k4, k5, k6] = *coefficients else { return None };
        Some(Self { numerator: [k1, k2, k3], denominator: [k4, k5, k6], p1, p2 })
    }

    fn coefficients(&self) -> Vec<f64> {
        let ([k1, k2, k3], [k4, k5, k6]) = (self.numerator, self.denominator);
        vec![k1, k2, self.p1, self.p2, k3, k4, k5, k6]
    }

    fn valid_radius(&self) -> f64 {
        let [n, d] = self.polynomials();
        let terms = [product(&n, &d), product(&derivative(&n), &d), product(&n, &derivative(&d))];
        let mut slope = vec![0.0; n.len() + d.len() - 1];
        for (sum, term) in slope.iter_mut().zip(&terms[0]) {
            *sum += term;
        }
        for (power, sum) in slope.iter_mut().enumerate().skip(1).take(terms[1].len()) {
            *sum += 2.0 * (terms[1][power - 1] - terms[2][power - 1]);
        }
        let above = [d[0] - LEAST_DENOMINATOR, d[1], d[2], d[3]];
        positive_up_to(&slope).min(positive_up_to(&above)).sqrt()
    }

    fn radius_after(&self, radius: f64) -> f64 {
        let [n, d] = self.polynomials().map(|c| value(&c, radius * radius));
        radius * n / d
    }
}

impl Distort for Rational {
    #[inline(always)]
    fn image<V: Real, const DERIVATIVE: bool>(&self, at: [V; 2], square: V) -> Image<V> {
        let s = |x: f64| V::splat(x);
        let ([k1, k2, k3], [k4, k5, k6]) = (&self.numerator, &self.denominator);
        let n = square.fma(square.fma(square.fma(s(*k3), s(*k2)), s(*k1)), s(1.0));
        let d = square.fma(square.fma(square.fma(s(*k6), s(*k5)), s(*k4)), s(1.0));
        // Beyond the domain any number will do that is one.
        let inverse = s(1.0) / d.select_gt(0.5 * LEAST_DENOMINATOR, d, s(1.0));
        let gain = n * inverse;
        let growth = if DERIVATIVE {
            let n = square.fma(square.fma(s(3.0 * *k3), s(2.0 * *k2)), s(*k1));
            let d = square.fma(square.fma(s(3.0 * *k6), s(2.0 * *k5)), s(*k4));
            gain.fnma(d, n) * inverse * s(2.0)
        } else {
            s(0.0)
        };
        decentred::<V, DERIVATIVE>(at, square, [gain, growth], [self.p1, self.p2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lens(numerator: [f64; 3], denominator: [f64; 3]) -> Rational {
        Rational { numerator, denominator, ..Rational::default() }
    }

    #[test]
    fn the_domain_ends_where_the_radius_stops_growing() {
        assert_eq!(lens([0.1, 0.0, 0.0], [0.0; 3]).valid_radius(), f64::INFINITY);
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        // Without a denominator it is Brown's polynomial.
        close(lens([-0.3, 0.0, 0.0], [0.0; 3]).valid_radius(), (1.0_f64 / 0.9).sqrt());
        // r / (1 + r²) has its maximum at 1.
        close(lens([0.0; 3], [1.0, 0.0, 0.0]).valid_radius(), 1.0);
        // r / (1 − r²) grows to its pole.
        close(lens([0.0; 3], [-1.0, 0.0, 0.0]).valid_radius(), (1.0 - LEAST_DENOMINATOR).sqrt());
    }
}
