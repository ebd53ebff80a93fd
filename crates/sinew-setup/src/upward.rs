//! Where up is, from a person who stands or walks.
//!
//! 1. Of each frame the direction from the middle of the ankles to the head, in points in space. Frames count in which the
//!    person is upright: one knee at least is bent by less than 30°, and the trunk is within 15° of the legs' middle line.
//! 2. Where the ankles are seen in less than half as many frames as the trunk, the direction is that from the middle of the
//!    hips to that of the shoulders; where two cameras see hips as rarely, that from the middle of the shoulders to that of
//!    the ears.
//! 3. The direction is the spatial median over the frames (Weiszfeld), which few frames do not move.
//! 4. Its variance per axis has three parts: that of the medians of eight runs of frames over 8; that of the points at both
//!    ends in a frame, since errors of detectors and cameras last and do not average out; and how far people who stand lean:
//!    3° from ankles to head, 6° from hips to shoulders, 15° from shoulders to ears. Where the thighs are bent by more than
//!    45° against the trunk in most frames that show a knee, the person sits, and the trunk may lean on: 10°. These numbers
//!    are judgements: a person who stood showed up 1.5° wrong, one who balanced on one leg 8°.
//!
//! Where ankles are seen and the legs never straight, as of people who sit or bend, nothing is said.

use super::space_points::Points;
use sinew_core::estimators::median;
use sinew_formats::Layout;

/// How the person showed where up is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UprightPart {
    /// From ankles to head.
    Whole,
    /// From hips to shoulders: the ankles were seen in too few frames.
    Trunk,
    /// From hips to shoulders of someone who sits.
    SeatedTrunk,
    /// From shoulders to ears: the hips were seen in too few frames, too.
    Head,
}

/// The direction that points up, in a calibration's world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upward {
    /// Unit vector.
    pub direction: [f64; 3],
    /// Standard deviation about each horizontal axis, degrees.
    pub sd_deg: f64,
    /// Frames from which it was found.
    pub frames: usize,
    /// What showed it.
    pub part: UprightPart,
}

impl Upward {
    /// Angle between the direction and the z axis, degrees.
    #[must_use]
    pub fn tilt_deg(&self) -> f64 {
        self.direction[2].clamp(-1.0, 1.0).acos().to_degrees()
    }
}

/// Fewest frames that say anything.
const FEWEST: usize = 3;

/// Least share of the frames that show the person in which they must be upright.
const LEAST_SHARE: f64 = 0.05;

/// Bend of the straighter knee of someone upright, degrees.
const KNEE_DEG: f64 = 30.0;

/// Angle between trunk and legs of someone upright, degrees.
const BEND_DEG: f64 = 15.0;

/// Angle between trunk and straighter thigh of someone who sits, degrees.
const SEAT_DEG: f64 = 45.0;

/// Runs of frames by which the scatter of the direction is judged.
const RUNS: usize = 8;

/// Standard deviation of the lean of people who stand or walk, degrees.
const fn lean_deg(part: UprightPart) -> f64 {
    match part {
        UprightPart::Whole => 3.0,
        UprightPart::Trunk => 6.0,
        UprightPart::SeatedTrunk => 10.0,
        UprightPart::Head => 15.0,
    }
}

/// The direction that points up, from points in space of some frames in their order; `None` where nobody stands.
#[must_use]
pub fn upward(layout: &Layout, frames: &[(u64, Points)]) -> Option<Upward> {
    let spans = |part| -> Vec<Span> { frames.iter().filter_map(|(_, points)| span(layout, points, part)).collect() };
    let parts = [UprightPart::Whole, UprightPart::Trunk, UprightPart::Head].map(|part| (part, spans(part)));
    let most = parts.iter().map(|(_, spans)| spans.len()).max().unwrap_or_default();
    let (part, found) = parts.into_iter().find(|(_, spans)| spans.len() >= FEWEST && 2 * spans.len() >= most)?;
    let part = if part == UprightPart::Trunk && sits(&found) { UprightPart::SeatedTrunk } else { part };
    let (standing, mut errors): (Vec<[f64; 3]>, Vec<f64>) = found.iter().filter_map(Span::upright).unzip();
    if standing.len() < FEWEST || (standing.len() as f64) < LEAST_SHARE * found.len() as f64 {
        return None;
    }
    let direction = spatial_median(&standing)?;
    let medians: Vec<[f64; 3]> = standing.chunks(standing.len().div_ceil(RUNS)).filter_map(spatial_median).collect();
    let apart: f64 = medians.iter().map(|median| squared(minus(*median, direction))).sum();
    // Two directions lie across the vertical.
    let variance = apart / (2.0 * medians.len().saturating_sub(1).max(1) as f64 * medians.len() as f64);
    let error = median(&mut errors);
    let sd_deg = variance.sqrt().hypot(error).to_degrees().hypot(lean_deg(part));
    Some(Upward { direction, sd_deg, frames: standing.len(), part })
}

/// From the lower to the upper end of a person in a frame.
struct Span {
    vector: [f64; 3],
    /// Per axis, square metres.
    variance: f64,
    is_upright: bool,
    /// Angle between the straighter thigh and the trunk, degrees.
    thigh_deg: Option<f64>,
}

/// Whether the thighs show someone who sits, in most of the frames that show one.
fn sits(found: &[Span]) -> bool {
    let mut thighs: Vec<f64> = found.iter().filter_map(|span| span.thigh_deg).collect();
    thighs.len() >= FEWEST && median(&mut thighs) > SEAT_DEG
}

impl Span {
    /// Unit vector and standard deviation (radians) of someone upright.
    fn upright(&self) -> Option<([f64; 3], f64)> {
        let length = squared(self.vector).sqrt();
        let is_long = self.is_upright && length > 0.0;
        is_long.then(|| (self.vector.map(|x| x / length), self.variance.sqrt() / length))
    }
}

/// The span of a frame, where its ends are seen.
fn span(layout: &Layout, points: &Points, part: UprightPart) -> Option<Span> {
    let at = |name: &str| points.get(layout.index(name)?).copied().flatten();
    let between = |left: &str, right: &str| {
        let ((left, left_variance), (right, right_variance)) = (at(left)?, at(right)?);
        let middle = [0, 1, 2].map(|k: usize| 0.5 * (left[k] + right[k]));
        Some((middle, 0.25 * (left_variance + right_variance)))
    };
    let ears = between("LEar", "REar");
    let shoulders = between("LShoulder", "RShoulder")?;
    if part == UprightPart::Head {
        let (head, variance) = ears?;
        return Some(Span {
            vector: minus(head, shoulders.0),
            variance: variance + shoulders.1,
            is_upright: true,
            thigh_deg: None,
        });
    }
    let hips = between("LHip", "RHip")?;
    let trunk = minus(shoulders.0, hips.0);
    if part == UprightPart::Trunk {
        let thigh = |[hip, knee]: [&str; 2]| Some(degrees_between(minus(at(hip)?.0, at(knee)?.0), trunk));
        let thighs = [["LHip", "LKnee"], ["RHip", "RKnee"]].map(thigh).into_iter().flatten();
        let thigh_deg = thighs.filter(|degrees| degrees.is_finite()).reduce(f64::min);
        return Some(Span { vector: trunk, variance: hips.1 + shoulders.1, is_upright: true, thigh_deg });
    }
    let ankles = between("LAnkle", "RAnkle")?;
    let head = ears.or_else(|| at("Neck")).unwrap_or(shoulders);
    let knee_deg = |[hip, knee, ankle]: [&str; 3]| {
        let (hip, knee, ankle) = (at(hip)?.0, at(knee)?.0, at(ankle)?.0);
        Some(degrees_between(minus(hip, knee), minus(knee, ankle)))
    };
    let knees = [["LHip", "LKnee", "LAnkle"], ["RHip", "RKnee", "RAnkle"]].map(knee_deg);
    let straighter = knees.into_iter().flatten().fold(f64::INFINITY, f64::min);
    let is_upright = straighter < KNEE_DEG && degrees_between(minus(hips.0, ankles.0), trunk) < BEND_DEG;
    Some(Span { vector: minus(head.0, ankles.0), variance: head.1 + ankles.1, is_upright, thigh_deg: None })
}

/// Angle between two vectors; NaN where one has no length.
fn degrees_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    (dot / (squared(a) * squared(b)).sqrt()).clamp(-1.0, 1.0).acos().to_degrees()
}

/// The unit vector with the least sum of distances from unit vectors, by Weiszfeld's iteration.
fn spatial_median(units: &[[f64; 3]]) -> Option<[f64; 3]> {
    const ROUNDS: usize = 100;
    const NEAR: f64 = 1e-9;
    let mean = |weights: &dyn Fn(&[f64; 3]) -> f64| {
        let sum = units.iter().fold([0.0; 3], |sum, unit| [0, 1, 2].map(|k: usize| sum[k] + weights(unit) * unit[k]));
        let length = squared(sum).sqrt();
        (length > NEAR).then(|| sum.map(|x| x / length))
    };
    let mut median = mean(&|_| 1.0)?;
    for _ in 0..ROUNDS {
        let next = mean(&|unit| 1.0 / squared(minus(*unit, median)).sqrt().max(NEAR))?;
        let moved = squared(minus(next, median));
        median = next;
        if moved < NEAR * NEAR {
            break;
        }
    }
    Some(median)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k: usize| a[k] - b[k])
}

fn squared(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::layout;

    /// A person of 1.7 m whose legs and trunk lie along two directions from the origin, in layout COCO_17.
    fn person(legs: [f64; 3], trunk: [f64; 3], has_legs: bool) -> Points {
        let layout = layout::find("COCO_17").unwrap();
        let at = |share: f64| {
            let (low, high) = (1.7 * share.min(0.5), 1.7 * (share - 0.5).max(0.0));
            Some(([0, 1, 2].map(|k: usize| low * legs[k] + high * trunk[k]), 0.0))
        };
        let share = |name: &str| match name.get(1..) {
            Some("Ankle") => has_legs.then_some(0.05),
            Some("Knee") => has_legs.then_some(0.27),
            Some("Hip") => Some(0.5),
            Some("Shoulder") => Some(0.8),
            Some("Ear") => Some(0.95),
            _ => None,
        };
        layout.points.iter().map(|name| at(share(name.as_deref()?)?)).collect()
    }

    fn found(frames: Vec<Points>) -> Option<Upward> {
        let frames: Vec<(u64, Points)> = (0..).zip(frames).collect();
        upward(&layout::find("COCO_17").unwrap(), &frames)
    }

    const UP: [f64; 3] = [0.6, 0.0, -0.8];

    #[test]
    fn the_person_says_where_up_is_with_and_without_legs() {
        for (has_legs, part, sd_deg) in [(true, UprightPart::Whole, 3.0), (false, UprightPart::Trunk, 6.0)] {
            let up = found(vec![person(UP, UP, has_legs); 20]).unwrap();
            assert!(squared(minus(up.direction, UP)) < 1e-20, "{up:?}");
            assert_eq!((up.part, up.frames), (part, 20));
            assert!((up.sd_deg - sd_deg).abs() < 1e-9, "{up:?}");
            assert!((up.tilt_deg() - 143.13).abs() < 0.01);
        }
    }

    #[test]
    fn somebody_who_sits_shows_up_less_surely() {
        let layout = layout::find("COCO_17").unwrap();
        let aside = [0.8, 0.0, 0.6];
        let seated = |has_ankles: bool, knee: [f64; 3]| {
            let mut frame = person(UP, UP, has_ankles);
            let hip = [0, 1, 2].map(|k: usize| 0.85 * UP[k]);
            for name in ["LKnee", "RKnee"] {
                let at = [0, 1, 2].map(|k: usize| hip[k] + 0.4 * knee[k]);
                frame[layout.index(name).unwrap()] = Some((at, 0.0));
            }
            frame
        };
        let mut frames = vec![seated(false, aside); 20];
        let up = found(frames.clone()).unwrap();
        assert!(squared(minus(up.direction, UP)) < 1e-20, "{up:?}");
        assert_eq!((up.part, up.sd_deg.round()), (UprightPart::SeatedTrunk, 10.0));
        // Ankles that are seen in a third of the frames.
        frames.extend(vec![seated(true, aside); 9]);
        assert_eq!(found(frames).unwrap().part, UprightPart::SeatedTrunk);
        let down = UP.map(|x| -x);
        assert_eq!(found(vec![seated(false, down); 20]).unwrap().part, UprightPart::Trunk);
    }

    #[test]
    fn without_hips_the_head_says_it_badly() {
        let mut frame = person(UP, UP, false);
        let layout = layout::find("COCO_17").unwrap();
        ["LHip", "RHip"].iter().for_each(|name| frame[layout.index(name).unwrap()] = None);
        let up = found(vec![frame; 20]).unwrap();
        assert!(squared(minus(up.direction, UP)) < 1e-20, "{up:?}");
        assert_eq!((up.part, up.sd_deg.round()), (UprightPart::Head, 15.0));
    }

    #[test]
    fn who_bends_or_lies_does_not_move_it() {
        let (aside, bent) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        let mut frames = vec![person(UP, UP, true); 14];
        frames.extend(vec![person(UP, bent, true); 30]);
        frames.extend(vec![person(aside, aside, true); 4]);
        let up = found(frames).unwrap();
        assert!(squared(minus(up.direction, UP)).sqrt().to_degrees() < 0.1, "{up:?}");
        assert_eq!(up.frames, 18);
        assert!(up.sd_deg > 3.5, "some frames contradict the others: {up:?}");
        assert_eq!(found(vec![person(UP, bent, true); 30]), None);
    }

    #[test]
    fn uncertain_ends_make_an_uncertain_direction() {
        let mut frame = person(UP, UP, false);
        frame.iter_mut().flatten().for_each(|(_, variance)| *variance = 1e-4);
        let sd_deg = found(vec![frame; 20]).unwrap().sd_deg;
        // A centimetre over both ends of 0.51 m.
        assert!((sd_deg - 6.0_f64.hypot((0.01_f64 / 0.51).to_degrees())).abs() < 1e-6, "{sd_deg}");
    }

    #[test]
    fn nobody_says_nothing() {
        assert_eq!(found(vec![vec![None; 17]; 20]), None);
        assert_eq!(found(vec![person(UP, UP, true); 2]), None);
        assert_eq!(found(vec![person([0.0; 3], [0.0; 3], true); 9]), None);
    }
}
