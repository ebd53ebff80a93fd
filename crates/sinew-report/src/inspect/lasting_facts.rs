//! What the set-up found of everything that is constant: posterior beside prior, and what was learned from the data.

use super::facts::Facts;
use sinew::setup::MeasuredErrors;
use sinew::setup::lasting_posterior::KnownNumber;
use sinew_body::point_derivatives::length_names;
use sinew_observe::Camera;
use sinew_observe::lasting::lasting_errors::LastingErrors;
use std::ops::Range;

/// Numbers of a camera by what they are: name, places in its error, factor to the unit shown, unit, digits.
const OF_CAMERA: [(&str, Range<usize>, f64, &str, usize); 5] = [
    ("turn", 0..3, 180.0 / std::f64::consts::PI, "°", 2),
    ("place", 3..6, 1e3, " mm", 1),
    ("focal length", 6..7, 1e2, " %", 2),
    ("principal point", 7..9, 1e3, " mrad", 1),
    ("k1", 9..10, 1.0, "", 3),
];
const PRINCIPAL_POINT: &str = "principal point";

/// Biases and places that are listed.
const LISTED: usize = 5;

/// Adds what is known of a set-up's constants; with the calibration the principal point is in pixels.
pub(super) fn add(facts: &mut Facts, known: &MeasuredErrors, calibration: &[Camera]) {
    let layout = known.layout();
    for (index, name) in known.cameras.iter().enumerate() {
        let camera = calibration.iter().find(|camera| camera.name == *name);
        for (what, places, factor, unit, digits) in OF_CAMERA {
            let first = layout.camera(index).start;
            let numbers = known_in(known, first + places.start..first + places.end);
            let value = match camera.filter(|_| what == PRINCIPAL_POINT) {
                Some(camera) => shown(&numbers, camera.intrinsics.fx, " px", digits),
                None => shown(&numbers, factor, unit, digits),
            };
            facts.row(format!("{name} {what}"), value);
        }
        if let Some(later) = known.lag_between(index) {
            facts.row(format!("{name} later than all"), shown(&[later], 1e3, " ms", 1));
        }
    }
    let shared = format!("± {:.1} ms, a shift of time that nothing shows", 1e3 * known.common_lag_sd_s());
    facts.row("lag of all cameras", shared);
    for (length, number) in length_names().into_iter().zip(known_in(known, layout.lengths())) {
        let KnownNumber { sd, prior_sd, .. } = number;
        facts.row(length.replace('_', " "), format!("± {:.0} mm, prior ± {:.0} mm", 1e3 * sd, 1e3 * prior_sd));
    }
    largest(facts, known, &layout);
    facts.row("learned from the data", learned(known, &layout));
}

fn known_in(known: &MeasuredErrors, places: Range<usize>) -> Vec<KnownNumber> {
    places.map(|place| known.known(place)).collect()
}

/// Numbers with the same unit and prior: means, standard deviations, that of the prior.
fn shown(numbers: &[KnownNumber], factor: f64, unit: &str, digits: usize) -> String {
    let listed = |of: &dyn Fn(&KnownNumber) -> String| match numbers {
        [one] => of(one),
        all => format!("({})", all.iter().map(of).collect::<Vec<_>>().join(", ")),
    };
    // Zero is added to take its sign from a number that is rounded to it.
    let rounded = |x: f64| (x * factor * 10_f64.powi(digits as i32)).round() / 10_f64.powi(digits as i32) + 0.0;
    let mean = listed(&|number| format!("{:+.digits$}", rounded(number.mean - number.prior_mean)));
    let sd = listed(&|number| format!("{:.digits$}", rounded(number.sd)));
    let prior = numbers.first().map_or(0.0, |number| rounded(number.prior_sd));
    format!("{mean} ± {sd}{unit}, prior ± {prior:.digits$}{unit}")
}

/// The largest biases, and the keypoints that lie farthest from their joints.
fn largest(facts: &mut Facts, known: &MeasuredErrors, layout: &LastingErrors) {
    let points = || known.points.iter().enumerate();
    let biases = known.cameras.iter().enumerate().flat_map(|(camera, name)| {
        points().map(move |(point, of)| (format!("bias of {of} in {name}"), layout.bias(camera, point)))
    });
    let places = points().map(|(point, of)| (format!("keypoint {of} on its link"), layout.place(point)));
    for all in [biases.collect::<Vec<_>>(), places.collect()] {
        let mut sized: Vec<(f64, String, Vec<KnownNumber>)> = all
            .into_iter()
            .map(|(name, range)| {
                let numbers = known_in(known, range);
                (numbers.iter().map(|number| (number.mean - number.prior_mean).powi(2)).sum(), name, numbers)
            })
            .collect();
        sized.sort_by(|a, b| b.0.total_cmp(&a.0));
        sized.into_iter().take(LISTED).for_each(|(_, name, numbers)| facts.row(name, shown(&numbers, 1e3, " mm", 1)));
    }
}

/// Of how many numbers of each kind the data say more than the prior.
fn learned(known: &MeasuredErrors, layout: &LastingErrors) -> String {
    let camera_numbers = |places: Range<usize>| {
        let numbers = move |camera| places.clone().map(move |place| layout.camera(camera).start + place);
        (0..layout.cameras).flat_map(numbers).collect::<Vec<usize>>()
    };
    let mut kinds: Vec<(&str, Vec<usize>)> =
        OF_CAMERA.into_iter().map(|(what, places, ..)| (what, camera_numbers(places))).collect();
    kinds.push(("lengths", layout.lengths().collect()));
    kinds.push(("places of keypoints", layout.places().collect()));
    kinds.push(("biases", layout.biases().collect()));
    let counted = |(what, places): &(&str, Vec<usize>)| {
        let learned = places.iter().filter(|place| known.known(**place).is_learned()).count();
        format!("{what} {learned} of {}", places.len())
    };
    let mut counted: Vec<String> = kinds.iter().map(counted).collect();
    let lags: Vec<KnownNumber> = (0..layout.cameras).filter_map(|camera| known.lag_between(camera)).collect();
    let learned = lags.iter().filter(|lag| lag.is_learned()).count();
    counted.push(format!("lags between cameras {learned} of {}", lags.len()));
    format!("the data say more than the prior of {}; the other numbers stay near their priors", counted.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_with_their_prior() {
        let number = |mean, sd| KnownNumber { mean, sd, prior_mean: 0.0, prior_sd: 0.02 };
        assert_eq!(shown(&[number(0.0123, 0.004)], 1e3, " mm", 0), "+12 ± 4 mm, prior ± 20 mm");
        let pair = [number(0.001, 0.004), number(-0.00001, 0.01)];
        assert_eq!(shown(&pair, 1.0, "", 3), "(+0.001, +0.000) ± (0.004, 0.010), prior ± 0.020");
    }
}
