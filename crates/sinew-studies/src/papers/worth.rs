//! What estimates are worth: distances of joints, and whether the person is kept.
//!
//! *Kept*: absolute error below 150 mm in 90 % of the frames, and a limb ratio of at most 0.6. The *limb ratio* is the mean distance of elbows, wrists, knees and ankles, taken from the pelvis, over that of the mean training pose at the true
//! position and heading.

use super::masked_scene::Scene;
use crate::support::statistics::mean;
use serde_json::{Value, json};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_tests::evaluation::joint_errors::joint_errors_mm;

const PELVIS: &str = "MidHip";
const LIMBS: [&str; 8] = ["LElbow", "RElbow", "LWrist", "RWrist", "LKnee", "RKnee", "LAnkle", "RAnkle"];
/// First coordinates, position and heading, which a mean pose takes from the true pose.
const PLACED: usize = 4;

/// Absolute error below which a frame counts, millimetres, and the least share of such frames.
const KEPT_MM: f64 = 150.0;
const KEPT_SHARE: f64 = 0.9;
/// Largest limb ratio of a person who is kept.
const KEPT_RATIO: f64 = 0.6;

/// Absolute error above which a person is lost, millimetres, for that many frames in a row; or limbs that are no nearer than the mean pose's over a second.
const LOST_MM: f64 = 250.0;
const LOST_FRAMES: usize = 10;
/// Absolute error, millimetres, and limb ratio below which a person is found again, for that many frames in a row.
const FOUND_MM: f64 = 120.0;
const FOUND_RATIO: f64 = 0.8;
const FOUND_FRAMES: usize = 5;

/// Distances frame by frame, millimetres.
#[derive(Clone)]
pub(super) struct Errors {
    pub(super) absolute: Vec<f64>,
    pub(super) relative: Vec<f64>,
    pub(super) limbs: Vec<f64>,
}

/// Errors of states, one for each frame of the motion from `first` on.
pub(super) fn errors(scene: &Scene, states: &[Vec<f64>], first: usize) -> Errors {
    let found = points_of_states(&scene.tree, states);
    let Trajectories { names, frames } = &scene.motion;
    let truth = Trajectories { names: names.clone(), frames: frames[first..].to_vec() };
    let [absolute, relative] = joint_errors_mm(&found, &truth);
    Errors { absolute, relative, limbs: limbs_mm(&found, &truth) }
}

fn limbs_mm(found: &Trajectories, truth: &Trajectories) -> Vec<f64> {
    let names: Vec<&str> = [PELVIS].into_iter().chain(LIMBS).collect();
    let [found, truth] = [found, truth].map(|points| points.select(&names));
    let from_pelvis = |frame: &[[f64; 3]], k: usize| [0, 1, 2].map(|i| frame[k][i] - frame[0][i]);
    let frame = |(a, b): (&Vec<[f64; 3]>, &Vec<[f64; 3]>)| {
        let joint = |k: usize| sinew_body::points::distance(from_pelvis(a, k), from_pelvis(b, k));
        1e3 * (1..a.len()).map(joint).sum::<f64>() / LIMBS.len() as f64
    };
    found.frames.iter().zip(&truth.frames).map(frame).collect()
}

/// What the estimates of some frames are worth, as it is stored: with that many decimals, beside the limbs of mean poses and the milliseconds a frame.
pub(super) fn stored(scene: &Scene, estimates: &[Vec<f64>], means: &[Vec<f64>], seconds: f64, decimals: i32) -> Value {
    let first = means.len() - estimates.len();
    let (found, mean_pose) = (errors(scene, estimates, first), errors(scene, &means[first..], first));
    json!({
        "absolute": rounded(&found.absolute, decimals),
        "relative": rounded(&found.relative, decimals),
        "limbs": rounded(&found.limbs, decimals),
        "mean_pose_limbs": rounded(&mean_pose.limbs, decimals),
        "ms": 1e3 * seconds / estimates.len() as f64,
    })
}

/// Numbers with some decimals.
pub(super) fn rounded(values: &[f64], decimals: i32) -> Vec<f64> {
    let factor = 10_f64.powi(decimals);
    values.iter().map(|x| (factor * x).round() / factor).collect()
}

/// The mean pose of training at the true position and heading, frame by frame.
pub(super) fn mean_poses(scene: &Scene, mean_pose: &[f64]) -> Vec<Vec<f64>> {
    scene.truth.iter().map(|truth| [&truth[..PLACED], &mean_pose[PLACED..]].concat()).collect()
}

/// Share of frames of small absolute error, the limb ratio, and whether the person is kept.
pub(super) fn kept(found: &Errors, mean_pose: &Errors) -> (f64, f64, bool) {
    let near = found.absolute.iter().filter(|error| **error < KEPT_MM).count() as f64 / found.absolute.len() as f64;
    let ratio = mean(&found.limbs) / mean(&mean_pose.limbs);
    (near, ratio, near >= KEPT_SHARE && ratio <= KEPT_RATIO)
}

/// Whether the person is lost somewhere; a second has that many frames.
pub(super) fn lost(found: &Errors, mean_pose: &Errors, second: usize) -> bool {
    let far = found.absolute.windows(LOST_FRAMES).any(|run| run.iter().all(|error| *error > LOST_MM));
    let limbs = found.limbs.windows(second).zip(mean_pose.limbs.windows(second));
    far || limbs.into_iter().any(|(limbs, reference)| mean(limbs) > mean(reference))
}

/// Whether the person is found again within some frames.
pub(super) fn recovered(found: &Errors, mean_pose: &Errors, within: std::ops::Range<usize>) -> bool {
    let is_found = |k: usize| found.absolute[k] < FOUND_MM && found.limbs[k] < FOUND_RATIO * mean_pose.limbs[k];
    let frames: Vec<bool> = (within.start..within.end.min(found.absolute.len())).map(is_found).collect();
    frames.windows(FOUND_FRAMES).any(|run| run.iter().all(|found| *found))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(absolute: &[f64], limbs: f64) -> Errors {
        Errors { absolute: absolute.to_vec(), relative: vec![], limbs: vec![limbs; absolute.len()] }
    }

    #[test]
    fn people_are_kept_lost_and_found_as_defined() {
        let mean_pose = errors(&[100.0; 40], 100.0);
        let near = errors(&[50.0; 40], 50.0);
        assert!(kept(&near, &mean_pose).2 && !lost(&near, &mean_pose, 15));
        assert!(!kept(&errors(&[50.0; 40], 61.0), &mean_pose).2);
        assert!(lost(&errors(&[50.0; 40], 101.0), &mean_pose, 15));
        let away = |frames: usize| [vec![50.0; 10], vec![260.0; frames], vec![110.0; 30 - frames]].concat();
        assert!(!lost(&errors(&away(9), 50.0), &mean_pose, 15) && lost(&errors(&away(10), 50.0), &mean_pose, 15));
        let back = errors(&away(12), 50.0);
        assert!(recovered(&back, &mean_pose, 20..30) && !recovered(&back, &mean_pose, 20..26));
        assert!(!recovered(&errors(&away(12), 81.0), &mean_pose, 20..40));
    }
}
