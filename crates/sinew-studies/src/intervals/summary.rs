//! Means over seeds, and whether ranks are uniform.

use super::protocol::{BINS, DRAWS};
use crate::support::outcome::Outcome;
use crate::support::statistics::{mean, mean_and_error};
use sinew_tests::evaluation::ranks;
use statrs::distribution::{ContinuousCDF as _, Normal, StudentsT};

/// Mean over seeds, and their standard deviation; one number alone has none.
pub(super) fn over_seeds(values: &[f64]) -> String {
    let [centre, error] = mean_and_error(values);
    let spread = error * (values.len() as f64).sqrt();
    if spread.is_nan() { format!("{centre:.1}") } else { format!("{centre:.1} ± {spread:.1}") }
}

/// The rank among [`DRAWS`] draws that a normal number of that many standard deviations has.
pub(super) fn normal_rank(deviations: f64) -> u32 {
    rank_of(Normal::standard().cdf(deviations))
}

/// Degrees of freedom of the errors of a camera.
const CAMERA_DEGREES: f64 = 4.0;

/// The same of a number that is Student's t with four degrees of freedom once its scale is known, of which there are draws.
pub(super) fn scale_mixture_rank(deviations: f64, scales: &[f64]) -> Outcome<u32> {
    let square = mean(scales.iter().map(|scale| scale * scale));
    // The variance of Student's t is n / (n − 2).
    let over = (CAMERA_DEGREES / (CAMERA_DEGREES - 2.0) * square).sqrt();
    let student = StudentsT::new(0.0, 1.0, CAMERA_DEGREES)?;
    Ok(rank_of(mean(scales.iter().map(|scale| student.cdf(deviations * over / scale)))))
}

fn rank_of(probability: f64) -> u32 {
    ((probability * (DRAWS as f64 + 1.0)) as u32).min(DRAWS as u32)
}

/// Probability of ranks as unequal as these, were they uniform and independent.
pub(super) fn uniformity(ranks: &[u32]) -> f64 {
    ranks::uniformity(ranks, DRAWS, BINS)
}

/// A probability as it is written.
pub(super) fn shown(p: f64) -> String {
    if p < 0.001 { "< 0.001".into() } else { format!("{p:.3}") }
}
