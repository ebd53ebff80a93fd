//! Sizes of somebody: an adult of whom nothing is known.

use crate::draws::normals;
use sinew_body::Proportions;
use sinew_body::point_derivatives::{lengthened, lengths};
use sinew_core::random::Stage;

/// Standard deviation of the stature of adults, men and women together, as a share of its mean (National Health Survey 1960–62, Vital and Health Statistics 11(8), table 2).
const STATURE: f64 = 0.057;
/// The same of a segment's length for someone of a stature: what the shares of the segments in it differ by.
const SEGMENT: f64 = 0.03;

/// The default body with the lengths of somebody; head and feet stay.
#[must_use]
pub fn drawn(stage: &Stage) -> Proportions {
    let usual = Proportions::default();
    let lengths = lengths(&usual);
    let normal = normals(stage, 0, 1 + lengths.len());
    let longer = |(length, own): (&f64, &f64)| length * (STATURE * normal[0] + SEGMENT * own);
    lengthened(&usual, &lengths.iter().zip(&normal[1..]).map(longer).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn adults_differ_in_stature_and_in_its_parts() {
        let usual = lengths(&Proportions::default());
        let people: Vec<Vec<f64>> = (0..2000).map(|seed| lengths(&drawn(&Stage::new(seed, "test")))).collect();
        let share = |person: &Vec<f64>, k: usize| person[k] / usual[k] - 1.0;
        let mean = |of: &dyn Fn(&Vec<f64>) -> f64| people.iter().map(of).sum::<f64>() / 2000.0;
        let expected = STATURE.hypot(SEGMENT);
        assert!(mean(&|person| share(person, 0)).abs() < 4.0 * expected / 2000.0_f64.sqrt());
        assert!((mean(&|person| share(person, 0).powi(2)).sqrt() / expected - 1.0).abs() < 0.05);
        let both = mean(&|person| share(person, 0) * share(person, 3)).sqrt();
        assert!((both / STATURE - 1.0).abs() < 0.1, "{both}");
    }
}
