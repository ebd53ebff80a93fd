//! What estimates are worth: distances of joints, and whether the person is kept.
//!
//! *Kept*: absolute error below 150 mm in 90 % of the frames, and a limb ratio of at most 0.6. The *limb ratio* is the mean distance of elbows, wrists, knees and ankles, taken from the pelvis, over that of the mean training pose at the true
//! position and heading.

use super::scene::Scene;
use sinew_motion::points::{Trajectories, points_of_states};
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

/// Distances frame by frame, millimetres.
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
        let joint = |k: usize| sinew_motion::points::distance(from_pelvis(a, k), from_pelvis(b, k));
        1e3 * (1..a.len()).map(joint).sum::<f64>() / LIMBS.len() as f64
    };
    found.frames.iter().zip(&truth.frames).map(frame).collect()
}

/// The mean pose of training at the true position and heading, frame by frame.
pub(super) fn mean_poses(scene: &Scene, mean_pose: &[f64]) -> Vec<Vec<f64>> {
    scene.truth.iter().map(|truth| [&truth[..PLACED], &mean_pose[PLACED..]].concat()).collect()
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Share of frames of small absolute error, the limb ratio, and whether the person is kept.
pub(super) fn kept(found: &Errors, mean_pose: &Errors) -> (f64, f64, bool) {
    let near = found.absolute.iter().filter(|error| **error < KEPT_MM).count() as f64 / found.absolute.len() as f64;
    let ratio = mean(&found.limbs) / mean(&mean_pose.limbs);
    (near, ratio, near >= KEPT_SHARE && ratio <= KEPT_RATIO)
}
