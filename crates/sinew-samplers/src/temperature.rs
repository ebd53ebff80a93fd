//! How far a likelihood may be sharpened before too few states survive.
//!
//! With log weights l_i the *survival diagnostic* of the exponent β is the effective number of the weights exp(β l_i),
//!
//! ```text
//! D(β) = (Σ exp β l_i)² / Σ exp 2 β l_i        d log D / dβ = 2 (E_β[l] − E_2β[l]) ≤ 0
//! ```
//!
//! which falls from the number of states that are reached at all (l_i > −∞) to the number of those with the largest l_i. The exponent at which D is a given part α of the reached states sets the layers of
//! annealing (Deutscher, Blake & Reid 2000, §3.2, after MacCormick & Isard 2000) and, as an increment, the temperatures of tempered sequential Monte Carlo (Jasra et al. 2011).

use crate::Error;
use crate::weights::normalise;

/// An exponent beyond all use: the weights are equal, or ties keep too many alive.
pub const MOST: f64 = (1_u64 << 40) as f64;

const BISECTIONS: usize = 60;
/// Of D / N, so small that where the bisection ends does not depend on the unit of the log weights.
const TOLERANCE: f64 = 1e-12;

/// The largest exponent up to `most` at which at least the part `survival` of the reached states survives.
///
/// # Errors
/// [`Error::OutOfRange`] unless 0 < survival < 1 and `most` > 0, [`Error::BadWeight`], [`Error::AllWeightsZero`].
pub fn exponent(log_weights: &[f64], survival: f64, most: f64) -> Result<f64, Error> {
    let range = |name, value, inside: bool, expected| {
        if inside { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
    };
    range("survival rate", survival, survival > 0.0 && survival < 1.0, "must be in (0, 1)")?;
    range("largest exponent", most, most > 0.0 && most.is_finite(), "must be positive and finite")?;
    normalise(log_weights, &mut Vec::new())?;
    let largest = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let reached: Vec<f64> = log_weights.iter().filter(|l| l.is_finite()).map(|l| l - largest).collect();
    let surviving = |beta: f64| {
        let (mut sum, mut squares) = (0.0, 0.0);
        for l in &reached {
            let w = (beta * l).exp();
            sum += w;
            squares += w * w;
        }
        sum * sum / squares / reached.len() as f64
    };
    let mut high = most.min(1.0);
    while surviving(high) >= survival {
        if high >= most {
            return Ok(most);
        }
        high = (2.0 * high).min(most);
    }
    let mut low = 0.0;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        let part = surviving(middle);
        if part >= survival {
            low = middle;
            if part - survival < TOLERANCE {
                break;
            }
        } else {
            high = middle;
        }
    }
    Ok(if low > 0.0 { low } else { high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weights::effective_number;

    #[test]
    fn the_wanted_part_survives() {
        let log_weights: Vec<f64> = (0..500).map(|i| -1e3 * f64::from(i * i % 101)).collect();
        for survival in [0.1, 0.5, 0.9] {
            let beta = exponent(&log_weights, survival, MOST).expect("weights");
            let mut weights = Vec::new();
            normalise(&log_weights.iter().map(|l| beta * l).collect::<Vec<_>>(), &mut weights).expect("weights");
            assert!((effective_number(&weights) / 500.0 - survival).abs() < 1e-5, "{survival}: {beta}");
        }
    }

    #[test]
    fn states_that_explain_nothing_do_not_count() {
        let some = [-3.0, -1.0, -7.0, -2.0];
        let mut all = some.to_vec();
        all.extend([f64::NEG_INFINITY; 9]);
        assert_eq!(exponent(&all, 0.5, MOST), exponent(&some, 0.5, MOST));
    }

    #[test]
    fn flat_weights_take_the_largest_exponent_and_bad_ones_are_refused() {
        assert_eq!(exponent(&[-2.0; 5], 0.5, MOST), Ok(MOST));
        assert_eq!(exponent(&[-2.0, -2.1], 0.5, 0.3), Ok(0.3));
        assert!(exponent(&[0.0, f64::NAN], 0.5, 1.0).is_err());
        assert!(exponent(&[f64::NEG_INFINITY], 0.5, 1.0).is_err());
        for survival in [0.0, 1.0, f64::NAN] {
            assert!(exponent(&[0.0], survival, 1.0).is_err());
        }
        assert!(exponent(&[0.0], 0.5, 0.0).is_err());
    }
}
