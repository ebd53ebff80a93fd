//! What intervals are worth on a recording.
//!
//! Observations of a camera that a run did not use are held against what the run predicts of them ([`sinew::predict`]).
//!
//! A camera's own constant offset, the median of observed − predicted, is taken off first: whatever the run is worth, it cannot know that, and it is common to all keypoints. It is reported in units of its own standard deviation. What remains is held against the
//! covariance that a keypoint has once this shift is taken off.

use sinew::predict::{CameraPrediction, Predicted};
use sinew_core::estimators::{mean, median};
use sinew_formats::svg::{Anchor, Svg};
use sinew_observe::association::Person;
use std::fmt::Write as _;

/// Detections of lower confidence are not compared.
pub const LEAST_CONFIDENCE: f64 = 0.5;

/// Probabilities of the regions that are reported.
pub const LEVELS: [f64; 4] = [0.5, 0.8, 0.9, 0.95];

/// Probabilities of the reliability curve.
const CURVE: [f64; 19] =
    [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95];

/// Observations of some keypoints against what was predicted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservationTally {
    /// Errors without the camera's offset, pixels.
    pub errors_px: Vec<f64>,
    /// Their squared distances in standard deviations.
    pub squares: Vec<f64>,
    /// Their log densities.
    pub log_scores: Vec<f64>,
}

impl ObservationTally {
    /// Share of the observations in the region of a probability.
    #[must_use]
    pub fn coverage(&self, probability: f64) -> f64 {
        let bound = -2.0 * (1.0 - probability).ln();
        self.squares.iter().filter(|square| **square <= bound).count() as f64 / self.squares.len() as f64
    }

    /// Error that this share of the observations does not exceed, pixels.
    #[must_use]
    pub fn quantile_px(&self, share: f64) -> f64 {
        let mut sorted = self.errors_px.clone();
        sorted.sort_by(f64::total_cmp);
        let last = sorted.len().saturating_sub(1);
        sorted.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
    }

    /// Mean log density.
    #[must_use]
    pub fn log_score(&self) -> f64 {
        mean(&self.log_scores)
    }

    /// Mean distance of the reliability curve from what it should be (Cotton and co-workers, arXiv 2601.22412).
    #[must_use]
    pub fn calibration_error(&self) -> f64 {
        CURVE.iter().map(|p| (self.coverage(*p) - p).abs()).sum::<f64>() / CURVE.len() as f64
    }

    fn merge(&mut self, other: &Self) {
        self.errors_px.extend(&other.errors_px);
        self.squares.extend(&other.squares);
        self.log_scores.extend(&other.log_scores);
    }
}

/// A camera that was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Its name.
    pub camera: String,
    /// Median of observed − predicted, pixels.
    pub offset_px: [f64; 2],
    /// Length of that in standard deviations: the root of half its squared distance, 1 when it is as large as expected.
    pub offset_size: f64,
    /// Keypoints with what was observed of them.
    pub keypoints: Vec<(String, ObservationTally)>,
}

impl LeftOut {
    /// All keypoints together.
    #[must_use]
    pub fn all(&self) -> ObservationTally {
        let mut all = ObservationTally::default();
        self.keypoints.iter().for_each(|(_, tally)| all.merge(tally));
        all
    }
}

/// rᵀ S⁻¹ r and the logarithm of S's determinant, S given as uu, uv, vv; `None` where it is no covariance.
fn distance([a, b]: [f64; 2], [uu, uv, vv]: [f64; 3]) -> Option<(f64, f64)> {
    let determinant = uu * vv - uv * uv;
    (determinant > 0.0 && uu > 0.0)
        .then(|| ((vv * a * a - 2.0 * uv * a * b + uu * b * b) / determinant, determinant.ln()))
}

/// What one person shows of the predicted keypoints: `columns` says which keypoint of the layout each is.
fn residuals(person: &Person, predicted: &[Option<Predicted>], columns: &[Option<usize>]) -> Vec<Option<[f64; 2]>> {
    let one = |(predicted, column): (&Option<Predicted>, &Option<usize>)| {
        let (predicted, seen) = ((*predicted)?, person.get((*column)?).copied().flatten()?);
        let counts = seen.confidence > LEAST_CONFIDENCE;
        counts.then(|| [0, 1].map(|axis: usize| seen.pixel[axis] - predicted.mean[axis]))
    };
    predicted.iter().zip(columns).map(one).collect()
}

/// Holds what a camera saw against a prediction. `people` are the camera's, frame by frame as predicted; who is nearest to what was predicted counts. `columns` is the place of each predicted keypoint in the layout.
#[must_use]
pub fn left_out(prediction: &CameraPrediction, people: &[Vec<Person>], columns: &[Option<usize>]) -> LeftOut {
    let count = prediction.keypoints.len().max(1);
    let nearest = |(people, predicted): (&Vec<Person>, &[Option<Predicted>])| {
        let seen = people.iter().map(|person| residuals(person, predicted, columns));
        let away = |seen: &Vec<Option<[f64; 2]>>| {
            median(&mut seen.iter().flatten().map(|[u, v]| u.hypot(*v)).collect::<Vec<_>>())
        };
        let usable = seen.map(|seen| (away(&seen), seen)).filter(|(away, _)| away.is_finite());
        usable.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(|| vec![None; count], |(_, seen)| seen)
    };
    let seen: Vec<Vec<Option<[f64; 2]>>> = people.iter().zip(prediction.predicted.chunks(count)).map(nearest).collect();
    let offset_px =
        [0, 1].map(|axis: usize| median(&mut seen.iter().flatten().flatten().map(|r| r[axis]).collect::<Vec<_>>()));
    let offset_size = distance(offset_px, prediction.common).map_or(f64::NAN, |(square, _)| (0.5 * square).sqrt());
    let mut keypoints: Vec<(String, ObservationTally)> =
        prediction.keypoints.iter().map(|name| (name.clone(), ObservationTally::default())).collect();
    for (seen, predicted) in seen.iter().zip(prediction.predicted.chunks(count)) {
        for ((residual, predicted), (_, tally)) in seen.iter().zip(predicted).zip(&mut keypoints) {
            let (Some(residual), Some(predicted)) = (residual, predicted) else { continue };
            let rest = [0, 1].map(|axis: usize| residual[axis] - offset_px[axis]);
            let Some((square, log_determinant)) = distance(rest, predicted.own) else { continue };
            tally.errors_px.push(rest[0].hypot(rest[1]));
            tally.squares.push(square);
            tally.log_scores.push(-0.5 * square - 0.5 * log_determinant - std::f64::consts::TAU.ln());
        }
    }
    LeftOut { camera: prediction.camera.name.clone(), offset_px, offset_size, keypoints }
}

/// All cameras together.
#[must_use]
pub fn together(cameras: &[LeftOut]) -> ObservationTally {
    let mut all = ObservationTally::default();
    cameras.iter().for_each(|camera| all.merge(&camera.all()));
    all
}

/// The table as text, a row a camera and keypoint, and `all` for each camera.
#[must_use]
pub fn to_csv(cameras: &[LeftOut]) -> String {
    let mut text =
        "camera,keypoint,count,error_median_px,error_90_px,inside_50,inside_80,inside_90,inside_95,log_score\n"
            .to_owned();
    for camera in cameras {
        let all = camera.all();
        let rows =
            std::iter::once(("all", &all)).chain(camera.keypoints.iter().map(|(name, tally)| (name.as_str(), tally)));
        for (name, tally) in rows.filter(|(_, tally)| !tally.squares.is_empty()) {
            let [a, b, c, d] = LEVELS.map(|level| tally.coverage(level));
            let (count, half, most, score) =
                (tally.squares.len(), tally.quantile_px(0.5), tally.quantile_px(0.9), tally.log_score());
            let _ = writeln!(
                text,
                "{},{name},{count},{half:.3},{most:.3},{a:.4},{b:.4},{c:.4},{d:.4},{score:.4}",
                camera.camera
            );
        }
    }
    text
}

/// Shares of 90 % regions, percent, between which intervals are taken at their word: of all cameras together, and of each.
const WORTH: [f64; 2] = [86.0, 96.0];
const EACH: [f64; 2] = [80.0, 98.0];

/// How many observations of a camera were predicted, and the share inside their regions of 90 %.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraCoverage {
    /// Name.
    pub camera: String,
    /// Observations.
    pub count: f64,
    /// Share inside.
    pub inside: f64,
}

/// What the intervals of this recording are worth, in a sentence.
#[must_use]
pub fn sentence(cameras: &[LeftOut]) -> String {
    let held = |camera: &LeftOut| {
        let tally = camera.all();
        CameraCoverage { camera: camera.camera.clone(), count: tally.squares.len() as f64, inside: tally.coverage(0.9) }
    };
    worth(&cameras.iter().map(held).collect::<Vec<_>>())
}

/// The same from how much each camera holds.
#[must_use]
pub fn worth(cameras: &[CameraCoverage]) -> String {
    let seen: Vec<&CameraCoverage> = cameras.iter().filter(|camera| camera.count > 0.0).collect();
    let count: f64 = seen.iter().map(|camera| camera.count).sum();
    if seen.is_empty() {
        return "no camera saw what the others predicted: nothing can be said about the intervals".into();
    }
    let aside: Vec<String> = seen
        .iter()
        .filter(|camera| !(EACH[0]..=EACH[1]).contains(&(100.0 * camera.inside)))
        .map(|camera| format!("{} {:.0} %", camera.camera, 100.0 * camera.inside))
        .collect();
    let inside = 100.0 * seen.iter().map(|camera| camera.count * camera.inside).sum::<f64>() / count;
    let worth = match inside {
        inside if inside < EACH[0] => "the intervals of this recording are too narrow",
        inside if inside < WORTH[0] => "the intervals of this recording are somewhat too narrow",
        inside if inside > WORTH[1] => "the intervals of this recording are wider than they need to be",
        _ if aside.is_empty() => "the intervals of this recording can be taken at their word",
        _ => "the intervals of this recording hold in the mean, and not for every camera",
    };
    let apart = if aside.is_empty() { String::new() } else { format!(" ({})", aside.join(", ")) };
    format!(
        "{inside:.0} % of what a camera sees lies where the others expect it with 90 %, its own offset aside: {worth}{apart}"
    )
}

/// Side of the square of the curve, and the space around it, pixels.
const SIDE: f64 = 360.0;
const MARGIN: f64 = 60.0;
const COLOURS: [&str; 6] = ["#2563eb", "#dc2626", "#059669", "#d97706", "#7c3aed", "#0891b2"];

/// The reliability curves: share of the observations inside against the probability of the region.
#[must_use]
pub fn to_svg(cameras: &[LeftOut]) -> String {
    let mut svg = Svg::new(SIDE + 2.0 * MARGIN + 140.0, SIDE + 2.0 * MARGIN);
    let at = |p: f64, share: f64| [MARGIN + SIDE * p, MARGIN + SIDE * (1.0 - share)];
    for tick in 0..=5 {
        let p = f64::from(tick) / 5.0;
        svg.line(at(p, 0.0), at(p, 1.0), 0.5, "#e5e7eb");
        svg.line(at(0.0, p), at(1.0, p), 0.5, "#e5e7eb");
        let ([x, y], [_, v]) = (at(p, 0.0), at(0.0, p));
        svg.label([x, y + 18.0], 12.0, Anchor::Middle, &format!("{:.0}", 100.0 * p));
        svg.label([MARGIN - 8.0, v + 4.0], 12.0, Anchor::End, &format!("{:.0}", 100.0 * p));
    }
    svg.line(at(0.0, 0.0), at(1.0, 1.0), 1.0, "#6b7280");
    svg.label([MARGIN + 0.5 * SIDE, SIDE + MARGIN + 40.0], 13.0, Anchor::Middle, "probability of the region, %");
    svg.upright([18.0, MARGIN + 0.5 * SIDE], 13.0, "observations inside, %");
    svg.text(MARGIN, 30.0, 15.0, "Cameras left out, each predicted by the others");
    for (index, camera) in cameras.iter().enumerate() {
        let (tally, colour) = (camera.all(), COLOURS[index % COLOURS.len()]);
        if tally.squares.is_empty() {
            continue;
        }
        let points: Vec<[f64; 2]> =
            std::iter::once(at(0.0, 0.0)).chain(CURVE.iter().map(|p| at(*p, tally.coverage(*p)))).collect();
        svg.polyline(&points, 2.0, colour);
        let y = MARGIN + 20.0 * (index as f64 + 1.0);
        svg.line([SIDE + MARGIN + 20.0, y - 4.0], [SIDE + MARGIN + 40.0, y - 4.0], 2.0, colour);
        svg.text(SIDE + MARGIN + 46.0, y, 12.0, &camera.camera);
    }
    svg.done()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_observe::Detection;

    /// A camera of which a share of a hundred observations lies inside 90 % regions.
    fn camera(name: &str, inside: usize) -> LeftOut {
        let squares = (0..100).map(|k| if k < inside { 1.0 } else { 9.0 }).collect();
        let tally = ObservationTally { squares, ..ObservationTally::default() };
        LeftOut { camera: name.into(), offset_px: [0.0; 2], offset_size: 1.0, keypoints: vec![("Nose".into(), tally)] }
    }

    #[test]
    fn a_sentence_says_what_intervals_are_worth_and_which_cameras_differ() {
        let said = |inside: &[usize]| {
            let cameras: Vec<LeftOut> = inside.iter().zip(["A", "B", "C"]).map(|(n, name)| camera(name, *n)).collect();
            sentence(&cameras)
        };
        let begin = "% of what a camera sees lies where the others expect it with 90 %, its own offset aside:";
        let expected = |inside: u32, rest: &str| format!("{inside} {begin} the intervals of this recording {rest}");
        assert_eq!(said(&[90, 88, 92]), expected(90, "can be taken at their word"));
        assert_eq!(
            said(&[99, 72, 99]),
            expected(90, "hold in the mean, and not for every camera (A 99 %, B 72 %, C 99 %)")
        );
        assert_eq!(said(&[85, 84, 83]), expected(84, "are somewhat too narrow"));
        assert_eq!(said(&[60, 90, 60]), expected(70, "are too narrow (A 60 %, C 60 %)"));
        assert_eq!(said(&[97, 97, 98]), expected(97, "are wider than they need to be"));
        assert!(said(&[]).starts_with("no camera saw"));
    }

    /// In a square of 360 px whose corner is at 60 px: the curve of a camera with 60 % inside 90 % regions passes (0.9, 0.6).
    #[test]
    fn curves_lie_where_the_axes_say() {
        let svg = to_svg(&[camera("A", 60)]);
        assert!(svg.contains("x1=\"60.0\" y1=\"420.0\" x2=\"420.0\" y2=\"60.0\""), "{svg}");
        assert!(svg.contains("points=\"60.0,420.0 ") && svg.contains(" 384.0,204.0"), "{svg}");
        for tick in 0..=5 {
            let along = |from: f64, by: f64| from + by * 72.0 * f64::from(tick);
            let number = format!(">{}</text>", 20 * tick);
            let [below, beside] = [[along(60.0, 1.0), 438.0], [52.0, along(424.0, -1.0)]];
            for [x, y] in [below, beside] {
                let place = format!("<text x=\"{x:.1}\" y=\"{y:.1}\"");
                assert!(
                    svg.lines().any(|line| line.starts_with(&place) && line.ends_with(&number)),
                    "{place} {number}"
                );
            }
        }
    }

    /// Ten frames of three keypoints, which the camera sees 7 px to the right, and one of them a pixel lower.
    #[test]
    fn a_camera_is_judged_without_its_own_offset() {
        let at = |u: f64, v: f64| Some(Predicted { mean: [u, v], total: [50.0, 0.0, 50.0], own: [4.0, 0.0, 1.0] });
        let camera = sinew_observe::Camera::look_at("C", [100.0; 2], 90.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let prediction = CameraPrediction {
            camera,
            frames: (0..10).collect(),
            keypoints: ["Nose", "Neck", "Head", "LHip"].map(str::to_owned).to_vec(),
            predicted: [at(10.0, 20.0), at(30.0, 40.0), at(50.0, 60.0), None].repeat(10),
            common: [49.0, 0.0, 49.0],
        };
        let seen = |u: f64, v: f64, confidence: f64| Some(Detection::new([u, v], confidence));
        let person = vec![seen(17.0, 20.0, 0.9), seen(37.0, 41.0, 0.9), seen(57.0, 60.0, 0.9), seen(0.0, 0.0, 0.9)];
        let far = vec![seen(90.0, 90.0, 0.9), None, None, None];
        let people = vec![vec![far, person]; 10];
        let found = left_out(&prediction, &people, &[0, 1, 2, 3].map(Some));
        assert_eq!(found.offset_px, [7.0, 0.0]);
        assert!((found.offset_size - 0.5_f64.sqrt()).abs() < 1e-12, "{}", found.offset_size);
        let tally = |k: usize| &found.keypoints[k].1;
        assert_eq!((tally(0).squares.len(), tally(3).squares.len()), (10, 0));
        assert_eq!((tally(0).squares[0], tally(1).squares[0]), (0.0, 1.0));
        let score = -0.5 * (1.0 + 4.0_f64.ln()) - std::f64::consts::TAU.ln();
        assert!((tally(1).log_scores[0] - score).abs() < 1e-12);
        assert_eq!((found.all().coverage(0.5), found.all().coverage(0.3)), (1.0, 20.0 / 30.0));
    }
}
