//! One cell: a contender over all frames with one seed. The pose of the first frame is known, all after it are judged.

use super::contender::{Contender, Disturbance, Method, Motion};
use super::motions::{BLANK_FRAMES, DISTURBED};
use super::trackers::Spaces;
use crate::papers::masked_scene::{Scene, Seen};
use crate::papers::worth::{mean_poses, stored};
use crate::support::outcome::Outcome;
use crate::support::processor_time::thread_seconds;
use serde_json::Value;
use sinew::core::random::Stage;
use std::f64::consts::PI;

/// How far a tracker is put aside: metres along x, and radians about the vertical.
const ASIDE_M: f64 = 1.0;
const ASIDE_RAD: f64 = PI / 3.0;
/// Coordinate of the heading.
const HEADING: usize = 3;

/// A pose put aside.
fn aside(pose: &[f64]) -> Vec<f64> {
    let mut pose = pose.to_vec();
    pose[0] += ASIDE_M;
    pose[HEADING] += ASIDE_RAD;
    pose
}

/// What a contender says of all frames but the first.
pub(super) struct Estimates {
    /// States of the body.
    pub(super) poses: Vec<Vec<f64>>,
    /// Shares of particles off the manifold, of a tracker that counts them.
    off_manifold: Vec<f64>,
    /// Processor time.
    seconds: f64,
}

/// Runs a contender.
pub(super) fn estimates(
    scene: &Scene,
    seen: &Seen,
    contender: &Contender,
    (spaces, mean_pose): (&Spaces, &[f64]),
    seed: u64,
) -> Outcome<Estimates> {
    let Contender { method, motion } = *contender;
    let disturbance = if let Motion::Disturbed(_, by) = motion { Some(by) } else { None };
    let mut running = spaces.tracker(method, &scene.truth[0])?;
    let means = mean_poses(scene, mean_pose);
    let purpose = format!("h-apf {}", method.name());
    let (mut estimates, mut off, mut seconds): (Vec<Vec<f64>>, _, _) = (vec![], vec![], 0.0);
    for (frame, truth) in scene.truth.iter().enumerate().skip(1) {
        let before = thread_seconds();
        let is_blank =
            disturbance == Some(Disturbance::Blank) && (DISTURBED..DISTURBED + BLANK_FRAMES).contains(&frame);
        if disturbance == Some(Disturbance::Displaced)
            && frame == DISTURBED
            && let Some(last) = estimates.last()
        {
            running = spaces.tracker(method, &aside(last))?;
        }
        estimates.push(match (&mut running, method) {
            (Some(running), _) => {
                let observed = if is_blank { seen.bind_blank(frame) } else { seen.bind(frame) };
                let info = running.step(&observed, Stage::new(seed, &purpose).at_frame(frame as u32))?;
                off.extend(info.off_manifold);
                info.mean
            }
            (None, Method::Truth) => truth.clone(),
            (None, Method::MeanPose) => means[frame].clone(),
            (None, _) => scene.truth[0].clone(),
        });
        seconds += thread_seconds() - before;
    }
    Ok(Estimates { poses: estimates, off_manifold: off, seconds })
}

/// What a contender's estimates are worth.
pub(super) fn cell(
    scene: &Scene,
    seen: &Seen,
    contender: &Contender,
    (spaces, mean_pose): (&Spaces, &[f64]),
    seed: u64,
) -> Outcome<Value> {
    let Estimates { poses, off_manifold, seconds } = estimates(scene, seen, contender, (spaces, mean_pose), seed)?;
    let mut cell = stored(scene, &poses, &mean_poses(scene, mean_pose), seconds, 2);
    if !off_manifold.is_empty() {
        cell["off_manifold"] = (off_manifold.iter().sum::<f64>() / off_manifold.len() as f64).into();
    }
    Ok(cell)
}
