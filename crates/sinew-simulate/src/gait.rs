//! Joint angles of walking over the gait cycle, as Fourier series.
//!
//! ```text
//! angle(φ) = c₀ + Σ_k a_k cos 2πkφ + b_k sin 2πkφ            φ: fraction of the cycle since this side's heel strike
//! ```
//!
//! **Source.** [`TABLE`] lists hip, knee and ankle flexion every 5 % of the cycle. We wrote its values, whole degrees, to follow the normative curves of adults at natural cadence that
//! Winter, *The Biomechanics and Motor Control of Human Gait*, 2nd ed. (1991), *Biomechanics and Motor Control of Human Movement*, 4th ed. (2009), and Perry & Burnfield, *Gait Analysis*,
//! 2nd ed. (2010) publish: their extremes and the times of these. It is neither a copy of a table nor digitised from a figure; expect it to be right to a few degrees, as published
//! curves agree with each other (Kadaba, Ramakrishnan & Wootten, J. Orthop. Res. 8 (1990) 383–392).
//!
//! The coefficients were fitted to [`TABLE`] by least squares (standard deviation 3.5°, about that between subjects) together with the condition that the foot of
//! a standard body neither slides nor leaves the ground while it bears weight (8 mm): published curves come from bodies with other proportions and bending toes. They differ
//! from the table by at most 5.5°. Harmonics: 4 (hip), 5 (knee), 6 (ankle).
//!
//! Pelvis, trunk and arms are single harmonics with the ranges of motion that these sources and Murray, Sepic & Barnard, Phys. Ther. 47 (1967) 272–284 (arms)
//! report; see [`crate::walker`].

use std::f64::consts::TAU;

/// Fourier series in the gait cycle, degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    /// Mean over the cycle.
    pub mean: f64,
    /// Cosine and sine coefficients of the harmonics 1, 2, ….
    pub harmonics: &'static [[f64; 2]],
}

impl Curve {
    /// Angle in radians at a fraction of the cycle.
    #[must_use]
    pub fn at(&self, phase: f64) -> f64 {
        let mut degrees = self.mean;
        for (k, [a, b]) in (1_u8..).zip(self.harmonics) {
            let (sin, cos) = (TAU * f64::from(k) * phase).sin_cos();
            degrees += a * cos + b * sin;
        }
        degrees.to_radians()
    }
}

/// Flexion of the thigh against the vertical, forward positive.
pub const HIP: Curve =
    Curve { mean: 8.25, harmonics: &[[19.01, -6.16], [-5.72, -0.39], [-0.51, 1.40], [-0.47, -0.09]] };

/// Flexion of the knee, positive.
pub const KNEE: Curve =
    Curve { mean: 24.39, harmonics: &[[-5.67, -19.89], [-14.24, 8.83], [-0.38, 3.62], [-0.40, 0.72], [0.10, 0.26]] };

/// Dorsiflexion of the ankle, toes up positive.
pub const ANKLE: Curve = Curve {
    mean: 1.49,
    harmonics: &[[-2.23, 7.99], [1.69, -8.28], [-3.48, 0.04], [2.20, 0.43], [0.47, -1.78], [-0.08, -0.05]],
};

/// Hip, knee and ankle flexion in degrees at 0, 5, …, 95 % of the cycle from heel strike, approximately as in the sources above.
pub const TABLE: [[f64; 20]; 3] = [
    [
        22.0, 22.0, 20.0, 16.0, 12.0, 8.0, 3.0, -2.0, -6.0, -10.0, -12.0, -10.0, -3.0, 6.0, 14.0, 20.0, 24.0, 25.0,
        24.0, 22.0,
    ],
    [
        4.0, 11.0, 17.0, 20.0, 19.0, 16.0, 13.0, 10.0, 8.0, 9.0, 14.0, 23.0, 38.0, 54.0, 63.0, 61.0, 50.0, 34.0, 16.0,
        5.0,
    ],
    [0.0, -4.0, -3.0, 0.0, 3.0, 5.0, 6.0, 8.0, 9.0, 9.0, 6.0, -3.0, -14.0, -18.0, -13.0, -6.0, -1.0, 1.0, 2.0, 1.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_stay_close_to_the_published_values() {
        for (curve, table) in [HIP, KNEE, ANKLE].iter().zip(&TABLE) {
            let mut squares = 0.0;
            for (i, expected) in (0_u8..).zip(table) {
                let difference = curve.at(f64::from(i) / 20.0).to_degrees() - expected;
                assert!(difference.abs() < 5.6, "{i}: {difference}");
                squares += difference * difference / 20.0;
            }
            assert!(squares.sqrt() < 3.2, "{}", squares.sqrt());
        }
    }

    #[test]
    fn curves_are_periodic() {
        for curve in [HIP, KNEE, ANKLE] {
            assert!((curve.at(0.3) - curve.at(1.3)).abs() < 1e-12);
        }
    }
}
