//! States of a body along a motion, each near the one before.
//!
//! Turns that no point shows so stay where they are.
//!
//! 1. In the first frame the body stands upright at the hips, turned as they are, elbows and knees slightly bent; in every other it starts from the pose before.
//! 2. Least squares on the points ([`fit_pose`]), angles unwrapped.
//!
//! For bodies whose root has a position and then, about z, a heading, and whose links have the names that HPPF24 and HAPF31 give them.

use crate::follow_error::FollowError;
use sinew_body::fit::{Config, Target, fit_pose};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_body::{KinematicTree, Plan};
use std::f64::consts::TAU;

/// Number of the coordinate from which on coordinates are angles.
const HEADING: usize = 3;

/// Links of elbows and knees with the angles of their hinges in the first start, radians.
const BENT: [(&str, f64); 4] = [("l_forearm", 0.3), ("r_forearm", 0.3), ("l_shin", -0.3), ("r_shin", -0.3)];

/// Points that the start of the first frame needs: middle, left, right.
const HIPS: [&str; 3] = ["MidHip", "LHip", "RHip"];

/// How a body follows a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionFollowing {
    /// Weight λ of the squared change of a coordinate from frame to frame; twists of straight limbs stay where they are.
    pub damping: f64,
    /// Further fits of the first frame, each from the last, since there is no frame before it to stay near.
    pub first_refits: usize,
}

impl Default for MotionFollowing {
    fn default() -> Self {
        Self { damping: Config::default().damping, first_refits: 0 }
    }
}

/// States of a body along a motion, one a frame; points that the motion lacks do not count.
///
/// # Errors
/// [`FollowError::Body`] where the motion has no hips.
pub fn states(
    body: &KinematicTree,
    motion: &Trajectories,
    how: &MotionFollowing,
) -> Result<Vec<Vec<f64>>, FollowError> {
    let columns: Vec<Option<usize>> = body.points().iter().map(|point| motion.index(&point.name)).collect();
    let plan = Plan::with_all_points(body);
    let config = Config { damping: how.damping, ..Config::default() };
    let hips = [motion.column(HIPS[0])?, motion.column(HIPS[1])?, motion.column(HIPS[2])?];
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(motion.frames.len());
    for frame in &motion.frames {
        let target = |k: usize| Target { position: frame[k], weight: 1.0 };
        let targets: Vec<Option<Target>> = columns.iter().map(|k| k.map(target)).collect();
        let start = states.last().cloned().unwrap_or_else(|| upright(body, hips.map(|k| frame[k])));
        let mut pose = fit_pose(&plan, &targets, &start, &config).pose;
        if states.is_empty() {
            for _ in 0..how.first_refits {
                pose = fit_pose(&plan, &targets, &pose, &config).pose;
            }
        }
        for (angle, before) in pose.iter_mut().zip(&start).skip(HEADING) {
            *angle -= TAU * ((*angle - before) / TAU).round();
        }
        states.push(pose);
    }
    Ok(states)
}

/// The body upright, the middle of its hips at theirs, turned as they are.
fn upright(body: &KinematicTree, [middle, left, right]: [[f64; 3]; 3]) -> Vec<f64> {
    let mut state = vec![0.0; body.dof()];
    let rest = points_of_states(body, std::slice::from_ref(&state)).select(&HIPS[..1]).frames.concat();
    let rest = rest.first().copied().unwrap_or_default();
    state[..HEADING].copy_from_slice(&[0, 1, 2].map(|k: usize| middle[k] - rest[k]));
    // At a heading of zero the right side is at +x.
    state[HEADING] = (right[1] - left[1]).atan2(right[0] - left[0]);
    for (link, angle) in BENT {
        if let Some(link) = body.link_index(link) {
            state[body.first_dof(link) + body.links()[link].joints.len() - 1] = angle;
        }
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::points::distance;
    use sinew_body::{Proportions, hapf31, hppf24};

    /// A body that walks along a curve, knees and elbows bending.
    fn moving(body: &KinematicTree) -> Vec<Vec<f64>> {
        let state = |frame: u32| {
            let t = f64::from(frame) / 20.0;
            let mut state = upright(body, [[t, 0.2 * t, 0.9], [0.0; 3], [1.0, 0.1, 0.0]]);
            state.iter_mut().skip(HEADING + 1).for_each(|angle| *angle *= 2.0 + t.sin());
            state
        };
        (0..8).map(state).collect()
    }

    fn bodies() -> [KinematicTree; 2] {
        [hppf24::tree(0.9), hapf31::sized(&Proportions::default())]
    }

    #[test]
    fn the_body_is_where_the_motion_is() {
        for body in bodies() {
            let motion = points_of_states(&body, &moving(&body));
            for how in [MotionFollowing::default(), MotionFollowing { damping: 1e-3, first_refits: 20 }] {
                let found = points_of_states(&body, &states(&body, &motion, &how).unwrap());
                let worst = found.frames.iter().flatten().zip(motion.frames.iter().flatten());
                let worst = worst.map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
                assert!(worst < 2e-3, "{how:?}: {worst} m");
            }
        }
    }

    #[test]
    fn headings_do_not_jump_where_the_body_turns_round() {
        for body in bodies() {
            let turn = |frame: u32| {
                let mut state = upright(&body, [[0.0, 0.0, 0.9], [0.0; 3], [1.0, 0.0, 0.0]]);
                state[HEADING] = 0.3 * f64::from(frame);
                state
            };
            let truth: Vec<Vec<f64>> = (0..30).map(turn).collect();
            let found = states(&body, &points_of_states(&body, &truth), &MotionFollowing::default()).unwrap();
            assert!((found[29][HEADING] - 0.3 * 29.0).abs() < 0.02, "{}", found[29][HEADING]);
        }
    }

    #[test]
    fn a_motion_without_hips_is_refused() {
        for body in bodies() {
            let found = states(&body, &Trajectories::default(), &MotionFollowing::default());
            assert_eq!(found, Err(FollowError::Body(sinew_body::Error::NoPoint("MidHip".into()))));
        }
    }
}
