//! What the density of a keypoint says of its residuals, in units of its standard deviation s.
//!
//! In two dimensions the squared distance q of a Gaussian error exceeds x with probability `exp(−x/2)`, that of Student's t with ν degrees of freedom with `(1 + x/ν)^(−ν/2)`. The
//! mean of q below a bound b is `(∫₀ᵇ P(q > x) dx − b P(q > b)) / P(q ≤ b)`.

use serde::{Deserialize, Serialize};
use sinew_observe::Noise;

/// Standardised residuals beyond this are gross.
pub(super) const GROSS: f64 = 4.0;

/// Expected residuals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Expected {
    /// Share of gross ones.
    pub(super) gross: f64,
    /// Mean square of the others, two axes together.
    pub(super) square: f64,
}

impl Expected {
    pub(super) fn of(noise: Noise) -> Self {
        let b = GROSS * GROSS;
        let (beyond, area, outlier) = match noise {
            Noise::OutlierFloor { outlier } => {
                let beyond = (-0.5 * b).exp();
                (beyond, 2.0 * (1.0 - beyond), outlier)
            }
            Noise::StudentT { degrees } => {
                let power = 1.0 - 0.5 * degrees;
                let spread = 1.0 + b / degrees;
                let area = match power.abs() < 1e-9 {
                    true => degrees * spread.ln(),
                    false => degrees / power * (spread.powf(power) - 1.0),
                };
                (spread.powf(-0.5 * degrees), area, 0.0)
            }
        };
        Self { gross: outlier + (1.0 - outlier) * beyond, square: (area - b * beyond) / (1.0 - beyond) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn expectations_match_the_densities() {
        // ∫ x e^(−x/2)/2 from 0 to 16 = 2 − 18 e⁻⁸
        let e8 = (-8.0_f64).exp();
        let gaussian = Expected::of(Noise::OutlierFloor { outlier: 0.02 });
        assert!((gaussian.gross - (0.02 + 0.98 * e8)).abs() < 1e-15);
        assert!((gaussian.square - (2.0 - 18.0 * e8) / (1.0 - e8)).abs() < 1e-12);
        // ν = 4: P(q > 16) = 5⁻² = 0.04, ∫ = 4 (1 − 1/5) = 3.2.
        let t = Expected::of(Noise::StudentT { degrees: 4.0 });
        assert!((t.gross - 0.04).abs() < 1e-12 && (t.square - (3.2 - 0.64) / 0.96).abs() < 1e-12);
        let two = Expected::of(Noise::StudentT { degrees: 2.0 });
        let near = Expected::of(Noise::StudentT { degrees: 2.0 + 1e-6 });
        assert!((two.square - near.square).abs() < 1e-5);
        // Many degrees of freedom are a Gaussian.
        let many = Expected::of(Noise::StudentT { degrees: 1e7 });
        assert!((many.square - gaussian.square).abs() < 1e-4);
    }
}
