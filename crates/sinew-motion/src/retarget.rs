//! A body in a recorded person's size, and its states along the recording.
//!
//! Sizes are robust medians over the frames, refined together with the poses; then each frame's pose is fitted by Levenberg–Marquardt from the frame before, its
//! angles continued without jumps. No smoothing. What the body cannot reach is reported as [`Retargeted::mean_error_m`].
//!
//! The recorded joints are the truth of an experiment with model error, the points of the fitted body that of one without.

use sinew_body::bundle;
use sinew_body::fit::{self, Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::points::{Trajectories, mean_distance, points_of_states};
use sinew_body::standard::{EVALUATION_JOINTS, h32};
use sinew_body::subject::{self, Measured};
use sinew_body::{Joint, KinematicTree, Plan, Proportions};
use std::f64::consts::TAU;

/// A motion of the standard body that follows recorded points.
#[derive(Clone, Debug, PartialEq)]
pub struct Retargeted {
    /// The body in the subject's size.
    pub body: KinematicTree,
    /// Its sizes.
    pub proportions: Proportions,
    /// States, one per frame.
    pub states: Vec<Vec<f64>>,
    /// Positions of all points of the body.
    pub points: Trajectories,
    /// Mean distance of the evaluation joints to their recorded positions, metres.
    pub mean_error_m: f64,
}

/// Fits the standard body H32 to recorded points; `None` where the first frame's trunk does not determine a pose.
#[must_use]
pub fn retarget(recorded: &Trajectories) -> Option<Retargeted> {
    retarget_to(h32, recorded)
}

/// Fits a body that is built from a subject's sizes, as [`retarget`] does.
#[must_use]
pub fn retarget_to(build: fn(&Proportions) -> KinematicTree, recorded: &Trajectories) -> Option<Retargeted> {
    let names: Vec<&str> = recorded.names.iter().map(String::as_str).collect();
    let frames: Vec<Vec<Option<[f64; 3]>>> =
        recorded.frames.iter().map(|frame| frame.iter().map(|&point| Some(point)).collect()).collect();
    let Measured { proportions, .. } = subject::from_distances(&names, &frames);
    let start = build(&proportions);
    let columns: Vec<Option<usize>> = start.points().iter().map(|point| recorded.index(&point.name)).collect();
    let targets: Vec<Vec<Option<Target>>> = recorded
        .frames
        .iter()
        .map(|frame| columns.iter().map(|k| k.map(|k| Target { position: frame[k], weight: 1.0 })).collect())
        .collect();
    let config = bundle::Config::default();
    let sample: Vec<_> = targets.iter().step_by(targets.len().div_ceil(SIZING_FRAMES).max(1)).cloned().collect();
    let proportions = bundle::refine(build, &proportions, &sample, &config).proportions;
    let body = build(&proportions);
    let plan = Plan::with_all_points(&body);
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(targets.len());
    for targets in &targets {
        let previous = match states.last() {
            Some(last) => last.clone(),
            None => initial_pose(&body, targets)?,
        };
        let pose = fit_pose(&plan, targets, &previous, &fit::Config::default()).pose;
        states.push(if states.is_empty() { pose } else { continued(&body, &pose, &previous) });
    }
    let points = points_of_states(&body, &states);
    let mean_error_m = mean_distance(&points.select(&EVALUATION_JOINTS), &recorded.select(&EVALUATION_JOINTS));
    Some(Retargeted { body, proportions, states, points, mean_error_m })
}

/// Frames that the sizes come from; more add nothing but time.
const SIZING_FRAMES: usize = 60;

/// The pose with every rotation moved by whole turns to the one nearest to the previous pose.
fn continued(body: &KinematicTree, pose: &[f64], previous: &[f64]) -> Vec<f64> {
    let turned = |((q, before), (_, joint)): ((&f64, &f64), (usize, Joint))| match joint {
        Joint::Rotate(_) => q - TAU * ((q - before) / TAU).round(),
        Joint::Translate(_) => *q,
    };
    pose.iter().zip(previous).zip(body.joints()).map(turned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cmu::joints;
    use crate::cmu::tests::trial;

    #[test]
    fn the_standard_body_follows_walking_running_and_dancing() {
        // The aim for such conversions is 30 mm.
        for (name, frames) in [("07_01", 79), ("09_06", 36), ("131_04", 272)] {
            let Some((skeleton, motion)) = trial(name) else { return };
            let fitted = retarget(&joints(&skeleton, &motion, 4.0)).unwrap();
            assert_eq!(fitted.states.len(), frames, "{name}");
            let millimetres = 1000.0 * fitted.mean_error_m;
            println!("{name}: {millimetres:.1} mm");
            assert!(millimetres < 30.0, "{name}: {millimetres} mm");
            for (before, after) in fitted.states.iter().zip(&fitted.states[1..]) {
                let jump = before.iter().zip(after).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(jump < 1.5, "{name}: {jump} rad");
            }
        }
    }
}
