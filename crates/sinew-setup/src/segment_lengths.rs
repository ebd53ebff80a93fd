//! Whether the person's segments have lengths that people have.
//!
//! Segments are shares of the stature (Drillis & Contini 1966, in Winter 2009, Biomechanics and Motor Control of Human Movement, figure 4.1). People are from 0.5 m (median
//! length of newborns, WHO Child Growth Standards 2006) to 2.51 m (the tallest living man, measured in 2011, Guinness World Records). Shares differ between
//! people and keypoints are no centres of joints, narrow ones least: half of the share of the smallest and 1.3 times that of the tallest are let pass.

use super::setup_error::{SegmentLength, SetupError};
use sinew_body::Proportions;
use sinew_body::subject::Measured;

/// Statures of people, metres.
const STATURES_M: [f64; 2] = [0.5, 2.51];
/// Factors on the shares of the smallest and the tallest.
const MARGINS: [f64; 2] = [0.5, 1.3];

/// Name for messages, share of the stature, length, and the size that measured it.
type Segment = (&'static str, f64, fn(&Proportions) -> f64, &'static str);

const SEGMENTS: [Segment; 7] = [
    ("upper arms", 0.186, |p| p.upper_arm, "upper_arm"),
    ("forearms", 0.146, |p| p.forearm, "forearm"),
    ("thighs", 0.245, |p| p.thigh, "thigh"),
    ("shins", 0.246, |p| p.shin, "shin"),
    ("shoulders", 0.259, |p| 2.0 * p.shoulder_half_width, "shoulder_half_width"),
    ("hips", 0.191, |p| 2.0 * p.hip_half_width, "hip_half_width"),
    ("a trunk", 0.288, |p| p.shoulder_height + p.pelvis_drop, "shoulder_height"),
];

/// Refuses a person with segments that nobody has; sizes that were not measured do not count.
///
/// # Errors
/// All such segments.
pub fn check(measured: &Measured, layout: &str) -> Result<(), SetupError> {
    let segments: Vec<SegmentLength> = SEGMENTS
        .iter()
        .filter(|(_, _, _, size)| !measured.unmeasured.contains(size))
        .filter_map(|(name, share, length, _)| {
            let found_m = length(&measured.proportions);
            let people_m = [0, 1].map(|end| MARGINS[end] * share * STATURES_M[end]);
            let is_plausible = (people_m[0]..=people_m[1]).contains(&found_m);
            (!is_plausible).then_some(SegmentLength { name, found_m, people_m })
        })
        .collect();
    if segments.is_empty() { Ok(()) } else { Err(SetupError::SegmentLengths { segments, layout: layout.into() }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::subject::scaled;

    fn refusal(proportions: Proportions, unmeasured: &[&'static str]) -> Option<String> {
        let measured = Measured { proportions, unmeasured: unmeasured.to_vec(), scale: 1.0 };
        check(&measured, "BODY_25B").err().map(|error| error.to_string())
    }

    #[test]
    fn people_from_newborns_to_giants_pass() {
        let adult = Proportions::default();
        for stature in [0.5, 0.9, 1.75, 2.51] {
            assert_eq!(refusal(scaled(&adult, stature / 1.75), &[]), None, "{stature} m");
        }
    }

    #[test]
    fn segments_that_nobody_has_are_named() {
        let adult = Proportions::default();
        let long = Proportions { shin: 1.12, ..adult };
        let expected = "the person would have shins of 1.12 m (people: 0.06 to 0.80 m); is `BODY_25B` the layout of the detector, and are translations in metres?";
        assert_eq!(refusal(long, &[]).as_deref(), Some(expected));
        assert_eq!(refusal(long, &["shin"]), None);
        // A calibration in another unit: everything is a tenth of what it is.
        let small = refusal(scaled(&adult, 0.1), &[]).unwrap_or_default();
        assert!(
            ["upper arms", "forearms", "thighs", "shins", "a trunk"].iter().all(|name| small.contains(name)),
            "{small}"
        );
        assert!(refusal(Proportions { thigh: f64::NAN, ..adult }, &[]).is_some());
    }
}
