//! HPPF24 in a person's size, and its states along a motion.
//!
//! 1. One scale for the whole body, from the lengths of some segments ([`scale`]).
//! 2. In the first frame the body stands upright at the hips, turned as they are, elbows and knees slightly bent; in every other it starts from the pose before.
//! 3. Least squares on the points ([`fit_pose`]), angles unwrapped ([`states`]).

use crate::error::Error;
use crate::points::{Trajectories, distance, points_of_states};
use sinew_body::fit::{Config, Target, fit_pose};
use sinew_body::{KinematicTree, Plan, hppf24};
use std::f64::consts::TAU;

/// Number of the coordinate from which on coordinates are angles.
const HEADING: usize = 3;

/// Coordinates of elbows and knees with their angles in the first start, radians.
const BENT: [(usize, f64); 4] = [(11, 0.3), (15, 0.3), (19, -0.3), (23, -0.3)];

/// Points that the start of the first frame needs: middle, left, right.
const HIPS: [&str; 3] = ["MidHip", "LHip", "RHip"];

/// How lengths of segments become a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Sum of the medians over all frames over the sum of the body's.
    Medians,
    /// Least squares of the lengths in the first frame.
    LeastSquares,
}

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

/// The scale of HPPF24, 1 for an adult of 1.75 m, by which its segments are as long as a motion's. A segment is a pair of names of points.
///
/// # Errors
/// [`Error::NoPoint`] for a point that the motion lacks, [`Error::NoFrames`].
pub fn scale(motion: &Trajectories, segments: &[(&str, &str)], how: Scale) -> Result<f64, Error> {
    let unit = hppf24::tree(1.0);
    let body = points_of_states(&unit, &[vec![0.0; unit.dof()]]);
    Ok(match how {
        Scale::Medians => sum_of_medians(motion, segments)? / sum_of_medians(&body, segments)?,
        Scale::LeastSquares => {
            let (own, theirs) = (first_lengths(&body, segments)?, first_lengths(motion, segments)?);
            let product: f64 = own.iter().zip(&theirs).map(|(a, b)| a * b).sum();
            product / own.iter().map(|a| a * a).sum::<f64>()
        }
    })
}

fn column(motion: &Trajectories, name: &str) -> Result<usize, Error> {
    motion.index(name).ok_or_else(|| Error::NoPoint(name.to_owned()))
}

fn sum_of_medians(motion: &Trajectories, segments: &[(&str, &str)]) -> Result<f64, Error> {
    let mut sum = 0.0;
    for (from, to) in segments {
        let (a, b) = (column(motion, from)?, column(motion, to)?);
        let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(frame[a], frame[b])).collect();
        all.sort_by(f64::total_cmp);
        sum += all.get(all.len() / 2).ok_or(Error::NoFrames)?;
    }
    Ok(sum)
}

fn first_lengths(motion: &Trajectories, segments: &[(&str, &str)]) -> Result<Vec<f64>, Error> {
    let frame = motion.frames.first().ok_or(Error::NoFrames)?;
    let length = |(from, to): &(&str, &str)| Ok(distance(frame[column(motion, from)?], frame[column(motion, to)?]));
    segments.iter().map(length).collect()
}

/// States of HPPF24 along a motion, one a frame; points that the motion lacks do not count.
///
/// # Errors
/// [`Error::NoPoint`] where the motion has no hips.
pub fn states(body: &KinematicTree, motion: &Trajectories, how: &MotionFollowing) -> Result<Vec<Vec<f64>>, Error> {
    let columns: Vec<Option<usize>> = body.points().iter().map(|point| motion.index(&point.name)).collect();
    let plan = Plan::with_all_points(body);
    let config = Config { damping: how.damping, ..Config::default() };
    let hips = [column(motion, HIPS[0])?, column(motion, HIPS[1])?, column(motion, HIPS[2])?];
    let mut states: Vec<Vec<f64>> = Vec::with_capacity(motion.frames.len());
    for frame in &motion.frames {
        let target = |k: usize| Target { position: frame[k], weight: 1.0 };
        let targets: Vec<Option<Target>> = columns.iter().map(|k| k.map(target)).collect();
        let start = states.last().cloned().unwrap_or_else(|| upright(body.dof(), hips.map(|k| frame[k])));
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

/// The body upright at the middle of the hips, turned as they are.
fn upright(dof: usize, [middle, left, right]: [[f64; 3]; 3]) -> Vec<f64> {
    let mut state = vec![0.0; dof];
    state[..3].copy_from_slice(&middle);
    // At a heading of zero the right side is at +x.
    state[HEADING] = (right[1] - left[1]).atan2(right[0] - left[0]);
    for (hinge, angle) in BENT {
        state[hinge] = angle;
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEGMENTS: [(&str, &str); 3] = [("LShoulder", "LElbow"), ("RHip", "RKnee"), ("RKnee", "RAnkle")];

    /// A body of that scale that walks along a curve, knees and elbows bending, and its states.
    fn moving(scale: f64) -> (KinematicTree, Vec<Vec<f64>>) {
        let body = hppf24::tree(scale);
        let state = |frame: u32| {
            let t = f64::from(frame) / 20.0;
            let mut state = upright(body.dof(), [[t, 0.2 * t, 0.9], [0.0; 3], [1.0, 0.1, 0.0]]);
            for (hinge, angle) in BENT {
                state[hinge] = angle * (2.0 + t.sin());
            }
            state
        };
        let states = (0..8).map(state).collect();
        (body, states)
    }

    #[test]
    fn both_scales_match_the_body_that_moved() {
        let (body, states) = moving(1.1);
        let motion = points_of_states(&body, &states);
        for how in [Scale::Medians, Scale::LeastSquares] {
            let found = scale(&motion, &SEGMENTS, how).unwrap();
            assert!((found - 1.1).abs() < 1e-9, "{how:?} {found}");
        }
    }

    #[test]
    fn the_body_is_where_the_motion_is() {
        let (body, truth) = moving(0.9);
        let motion = points_of_states(&body, &truth);
        for how in [MotionFollowing::default(), MotionFollowing { damping: 1e-3, first_refits: 20 }] {
            let found = points_of_states(&body, &states(&body, &motion, &how).unwrap());
            let worst = found.frames.iter().flatten().zip(motion.frames.iter().flatten());
            let worst = worst.map(|(a, b)| distance(*a, *b)).fold(0.0, f64::max);
            assert!(worst < 2e-3, "{how:?}: {worst} m");
        }
    }

    #[test]
    fn headings_do_not_jump_where_the_body_turns_round() {
        let body = hppf24::tree(1.0);
        let turn = |frame: u32| {
            let mut state = upright(body.dof(), [[0.0, 0.0, 0.9], [0.0; 3], [1.0, 0.0, 0.0]]);
            state[HEADING] = 0.3 * f64::from(frame);
            state
        };
        let truth: Vec<Vec<f64>> = (0..30).map(turn).collect();
        let found = states(&body, &points_of_states(&body, &truth), &MotionFollowing::default()).unwrap();
        assert!((found[29][HEADING] - 0.3 * 29.0).abs() < 0.02, "{}", found[29][HEADING]);
    }

    #[test]
    fn a_motion_without_hips_or_frames_is_refused() {
        let body = hppf24::tree(1.0);
        let nothing = Trajectories::default();
        assert_eq!(states(&body, &nothing, &MotionFollowing::default()), Err(Error::NoPoint("MidHip".into())));
        assert_eq!(scale(&nothing, &SEGMENTS, Scale::Medians), Err(Error::NoPoint("LShoulder".into())));
        let named = Trajectories { names: vec!["LShoulder".into(), "LElbow".into()], frames: vec![] };
        assert_eq!(scale(&named, &SEGMENTS[..1], Scale::Medians), Err(Error::NoFrames));
        assert_eq!(scale(&named, &SEGMENTS[..1], Scale::LeastSquares), Err(Error::NoFrames));
    }
}
