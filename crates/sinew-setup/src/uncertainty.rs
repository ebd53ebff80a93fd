//! What the intervals of a run come from, joint by joint and in words.
//!
//! The variance of a joint's position, over the frames of a run, is that of what is constant ([`super::lasting_sources`], as the set-up found it) and the rest, which each frame has of its own: noise of the keypoints, and motion between frames.

use super::lasting_sources::{PointSources, SOURCES};
use serde::Serialize;
use sinew_input::flag::flag;

/// What the uncertainty of a joint comes from: shares of its variance, which add to 1. A share is negative where the errors of a source cancel those of another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointUncertainty {
    /// Name of the point.
    pub joint: String,
    /// Root of the mean variance over frames and axes, metres.
    pub sd_m: f64,
    /// Of each frame alone.
    pub frames: f64,
    /// Of the cameras.
    pub cameras: f64,
    /// Of the lengths of the body.
    pub lengths: f64,
    /// Of the places of keypoints on their links.
    pub places: f64,
    /// Of biases of detectors.
    pub biases: f64,
    /// Of lags of the cameras.
    pub lags: f64,
}

/// What the uncertainty of a run comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Uncertainty {
    /// All joints together.
    pub words: String,
    /// For each source that is the largest one of some joints: of which, and what would help.
    pub help: Vec<String>,
    /// Each joint.
    pub joints: Vec<JointUncertainty>,
}

/// Joints that are listed.
const LISTED: usize = 8;

/// Names of the sources in words, and what would help against each; the first are the frames themselves.
const WORDS: [(&str, &str); SOURCES + 1] = [
    ("noise of each frame", "another camera"),
    ("cameras", "a better calibration"),
    ("lengths of the body", "measured lengths, or a recording in which the limbs bend and turn"),
    ("places of keypoints", "a static trial with measured joints"),
    ("biases of detectors", "another camera from another side, or more frames in which the person turns"),
    ("lags of the cameras", "cameras with one trigger"),
];

impl JointUncertainty {
    fn new(sources: &PointSources, variance: f64) -> Self {
        let lasting: f64 = sources.parts().iter().sum();
        // Where a set-up is another recording's, its parts may be more than all.
        let all = variance.max(lasting);
        let [cameras, lengths, places, biases, lags] =
            sources.parts().map(|part| if all > 0.0 { part / all } else { 0.0 });
        let frames = 1.0 - cameras - lengths - places - biases - lags;
        let sd_m = (variance / 3.0).sqrt();
        Self { joint: sources.point.clone(), sd_m, frames, cameras, lengths, places, biases, lags }
    }

    const fn shares(&self) -> [f64; SOURCES + 1] {
        [self.frames, self.cameras, self.lengths, self.places, self.biases, self.lags]
    }

    /// The largest source.
    fn largest(&self) -> usize {
        let shares = self.shares();
        (0..shares.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b])).unwrap_or_default()
    }
}

/// What the uncertainty comes from, of a run whose joints have these variances (sums over the axes, square metres); `None` where nothing is known of them.
#[must_use]
pub fn uncertainty(sources: &[PointSources], variances: &[(&str, f64)], is_smoothed: bool) -> Option<Uncertainty> {
    let of = |&(name, variance): &(&str, f64)| {
        let sources = sources.iter().find(|sources| sources.point == name)?;
        variance.is_finite().then(|| JointUncertainty::new(sources, variance))
    };
    let joints: Vec<JointUncertainty> = variances.iter().filter_map(of).collect();
    let all: f64 = joints.iter().map(|joint| joint.sd_m.powi(2)).sum();
    if all.is_nan() || all <= 0.0 {
        return None;
    }
    let share = |source: usize| joints.iter().map(|j| j.shares()[source] * j.sd_m.powi(2)).sum::<f64>() / all;
    let mut order: Vec<usize> = (0..WORDS.len()).collect();
    order.sort_by(|&a, &b| share(b).total_cmp(&share(a)));
    let named = |&source: &usize| format!("{} {:.0} %", WORDS[source].0, 100.0 * share(source));
    let words = order.iter().map(named).collect::<Vec<_>>().join(", ");
    let help = order.iter().filter_map(|&source| help_against(source, &joints, is_smoothed)).collect();
    Some(Uncertainty { words, help, joints })
}

/// Of which joints a source is the largest, and what would help.
fn help_against(source: usize, joints: &[JointUncertainty], is_smoothed: bool) -> Option<String> {
    let its: Vec<&JointUncertainty> = joints.iter().filter(|joint| joint.largest() == source).collect();
    let mut shares: Vec<f64> = its.iter().map(|joint| (100.0 * joint.shares()[source]).round()).collect();
    shares.sort_by(f64::total_cmp);
    let listed = its.iter().take(LISTED).map(|joint| joint.joint.as_str()).collect::<Vec<_>>().join(", ");
    let whose = match its.len() {
        0 => return None,
        count if count == joints.len() => "all points".into(),
        count if count > LISTED => format!("{listed} and {} more", count - LISTED),
        _ => listed,
    };
    let range = match shares[..] {
        [least, .., most] if least < most => format!("{least} to {most} %"),
        _ => format!("{} %", shares[0]),
    };
    let (name, help) = WORDS[source];
    let smoothing = if source == 0 && !is_smoothed { format!(", or {}", flag("smooth")) } else { String::new() };
    Some(format!("{name}: the largest part of {whose} ({range} of the variance); would help: {help}{smoothing}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sources(point: &str, [cameras_m2, lengths_m2, places_m2, biases_m2]: [f64; 4]) -> PointSources {
        PointSources { point: point.into(), cameras_m2, lengths_m2, places_m2, biases_m2, lags_m2: 0.0 }
    }

    #[test]
    fn shares_add_to_one_and_the_largest_is_named() {
        let known = [sources("Nose", [6e-4, 0.0, 0.0, 1e-4]), sources("RWrist", [1e-4, -1e-4, 0.0, 4e-4])];
        let found = uncertainty(&known, &[("Nose", 1e-3), ("RWrist", 1e-3), ("Tail", 1.0)], false).unwrap();
        for joint in &found.joints {
            assert!((joint.shares().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!((joint.sd_m - (1e-3_f64 / 3.0).sqrt()).abs() < 1e-12);
        }
        assert_eq!(found.joints[0].shares().map(|x| (10.0 * x).round()), [3.0, 6.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(
            found.words,
            "noise of each frame 45 %, cameras 35 %, biases of detectors 25 %, places of keypoints 0 %, lags of the cameras 0 %, lengths of the body -5 %"
        );
        assert_eq!(
            found.help,
            [
                "noise of each frame: the largest part of RWrist (60 % of the variance); would help: another camera, or `--smooth`",
                "cameras: the largest part of Nose (60 % of the variance); would help: a better calibration",
            ]
        );
    }

    #[test]
    fn errors_of_the_cameras_alone_are_all_of_it() {
        let known = [sources("Nose", [6e-4, 0.0, 0.0, 0.0]), sources("RWrist", [4e-4, 0.0, 0.0, 0.0])];
        // A set-up of another recording may say more than there is.
        let found = uncertainty(&known, &[("Nose", 6e-4), ("RWrist", 3e-4)], true).unwrap();
        assert!(found.joints.iter().all(|joint| joint.cameras == 1.0 && joint.frames == 0.0));
        assert_eq!(
            found.help,
            ["cameras: the largest part of all points (100 % of the variance); would help: a better calibration"]
        );
        assert_eq!(uncertainty(&[], &[("Nose", 1e-3)], true), None);
        assert_eq!(uncertainty(&known, &[("Nose", f64::NAN)], true), None);
    }

    /// A point of three times the variance counts three times as much among all.
    #[test]
    fn points_count_among_all_by_their_variance() {
        let known = [sources("Nose", [3e-3, 0.0, 0.0, 0.0]), sources("RWrist", [0.0; 4])];
        let found = uncertainty(&known, &[("Nose", 3e-3), ("RWrist", 1e-3)], true).unwrap();
        assert!(found.words.starts_with("cameras 75 %, noise of each frame 25 %"), "{}", found.words);
    }
}
