//! Motion noise of a recording, measured from poses that are fitted frame by frame.

use super::looked_frames::straight;
use super::motion_noise::measured_sd;
use super::pose_fit::pose_of;
use super::stored::Setup;
use crate::Error;
use sinew_body::KinematicTree;
use sinew_body::leg_turns::{leg_turns, shows_feet};
use sinew_input::source::FrameSource;
use sinew_observe::association;
use sinew_observe::association::following::{Following, follow};
use std::ops::Range;

/// Runs of consecutive frames from which the motion noise is measured, evenly spaced, and frames of each.
const MOTION_RUNS: u64 = 5;
const MOTION_FRAMES: u64 = 30;

/// Motion noise of a recording, from poses fitted to some of its frames one by one ([`measured_sd`]).
///
/// Where keypoints show no feet, legs that are straight turn about themselves at random in these fits: a leg is taken to turn no more than its thigh swings.
///
/// # Errors
/// Errors of the source.
pub fn measure_motion(
    setup: &Setup,
    tree: &KinematicTree,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    fps: f64,
) -> Result<Vec<f64>, Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let total = numbers.end - numbers.start;
    let stride = (total / MOTION_RUNS).max(MOTION_FRAMES);
    let mut poses = vec![];
    for first in numbers.clone().step_by(stride as usize) {
        let mut following = Following { person: setup.person, ..Following::default() };
        poses.push(None);
        let mut run = vec![];
        for number in first..(first + MOTION_FRAMES).min(numbers.end) {
            let people = source.people(number)?;
            run.push(follow(&mut following, &cameras, &people, None, &association::Config::default()).people);
        }
        for sighted in straight(&run, tree, &layout) {
            let former: Option<&[f64]> = poses.last().and_then(Option::as_deref);
            let pose = pose_of(setup, &cameras, &layout, &sighted, former);
            poses.push(pose.filter(|pose| pose.len() == tree.dof()));
        }
    }
    let mut sd = measured_sd(tree, &poses, fps);
    if !shows_feet(tree, |name| layout.index(name).is_some()) {
        for [turn, one, other] in leg_turns(tree) {
            sd[turn] = sd[turn].min(sd[one].max(sd[other]));
        }
    }
    Ok(sd)
}
