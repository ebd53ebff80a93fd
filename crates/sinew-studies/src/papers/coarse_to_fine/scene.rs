//! The sequence of the study: motion, body, true poses, and what is learned from other trials.
//!
//! - **Test**: the first 330 frames of CMB at 60 frames a second (walking, 2 s of a join, the start of running). Without recordings the synthetic sequence.
//! - **Pilot**: the first frames of the training motion in place of the test.
//! - **Body**: HPPF24 with cylinders. One scale, that of least squares of the lengths of limbs, trunk and head against the subject's.
//! - **True poses**: fitted to the joints frame by frame. Trackers are given only the first one.
//! - **Training**: two other walks of the subject, joined and bent as the test is; it has no running, of which the subject has no other trial. δ are the root mean squares of the changes of the poses fitted to it, which also settle the girths ([`super::girth`]). Ranges are nominal ones of the body; ±3 m around the start for the position, where the specification says ±2 m: the subject goes round on a circle 2.4 m across.

use super::girth::Girths;
use crate::papers::masked_scene::SEGMENTS;
use crate::support::outcome::Outcome;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::body::{KinematicTree, hppf24};
use sinew::files::fnv;
use sinew::samplers::grid::{self, GridAxis, LEAST_WIDTH, Width};
use sinew_body::points::mean_distance;
use sinew_body::points::{Trajectories, points_of_states};
use sinew_motion::damped_fit::{self, MotionFollowing};
use sinew_motion::hppf24_scale::{self, Scale};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::combo::{Sequence, TURN_RADIUS_M, Trial, combo, synthetic_combo};
use sinew_tests::evaluation::joint_errors::joint_errors_mm;
use sinew_tests::recorded_motion::{recorded, recorded_combo};
use std::f64::consts::PI;
use std::path::Path;

/// Frames per second.
pub(super) const RATE_HZ: f64 = 60.0;
/// Frames that are tracked at most.
pub(super) const FRAMES: usize = 330;
/// Number of the coordinate that wraps.
pub(super) const HEADING: usize = 3;
/// Camera of the ring that sees the person: C1.
pub(super) const CAMERA: usize = 0;
/// Half the range of the position, metres.
const REACH_M: f64 = 3.0;

/// Trials for training, with the skeleton `07`.
const TRAINING: [&str; 2] = ["07_02", "07_05"];

/// The grid of one coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    /// δ of the coordinate.
    pub(super) width: f64,
    pub(super) axis: GridAxis,
}

/// A motion, the body that follows it, and what that body's tracker knows.
pub(super) struct Scene {
    /// `CMB` or `synthetic CMB`.
    pub(super) name: String,
    /// All frames of the sequence, of which the first [`FRAMES`] are tracked: cameras stand around all.
    pub(super) motion: Trajectories,
    pub(super) tree: KinematicTree,
    pub(super) scale: f64,
    /// Poses fitted to the tracked frames.
    pub(super) truth: Vec<Vec<f64>>,
    pub(super) ranges: Vec<Range>,
    /// Mean distance of the fitted joints, test and training, metres.
    pub(super) fit_error_m: [f64; 2],
    pub(super) training_frames: usize,
    /// Means of the coordinates of the training poses.
    pub(super) mean_pose: Vec<f64>,
    pub(super) girths: Girths,
    /// Names of the phases with their first frames.
    pub(super) phases: Vec<(String, usize)>,
}

fn error_m(tree: &KinematicTree, states: &[Vec<f64>], motion: &Trajectories) -> f64 {
    mean_distance(&points_of_states(tree, states).select(&EVALUATION_JOINTS), &motion.select(&EVALUATION_JOINTS))
}

/// A motion for training that is none of the test's.
fn training(folder: Option<&Path>) -> Outcome<Sequence> {
    let trials: Vec<Trial> = match folder {
        Some(folder) => TRAINING
            .iter()
            .map(|&name| -> Outcome<Trial> {
                let motion = folder.join(format!("{name}.amc"));
                let motion = recorded(&motion, &folder.join("07.asf"), RATE_HZ)?;
                Ok(Trial { name: name.into(), motion, turn_radius_m: Some(TURN_RADIUS_M) })
            })
            .collect::<Outcome<_>>()?,
        None => [1.3, 0.9]
            .map(|stride_s| {
                let walker = Walker::new(Gait { still_s: 0.0, stride_s, ..Gait::default() });
                let motion = points_of_states(&walker.body, &walker_states(&walker, RATE_HZ));
                Trial { name: format!("walk of {stride_s} s"), motion, turn_radius_m: Some(TURN_RADIUS_M) }
            })
            .into(),
    };
    Ok(combo("training", &trials, RATE_HZ)?)
}

/// Steps learned from training, ranges around the start.
fn ranges(states: Vec<Vec<f64>>, start: &[f64]) -> Outcome<Vec<Range>> {
    let wraps: Vec<bool> = (0..start.len()).map(|j| j == HEADING).collect();
    let learned = grid::train(&[states], &wraps, Width::default())?;
    let range = |(j, learned): (usize, &GridAxis)| {
        let [low, high] = match hppf24::ranges()[j] {
            Some(range) => range,
            None if j == HEADING => [-PI, PI],
            None => [start[j] - REACH_M, start[j] + REACH_M],
        };
        let width = learned.width().max(LEAST_WIDTH);
        Ok(Range { low, high, width, axis: GridAxis::new(low, high, width, wraps[j])? })
    };
    learned.iter().enumerate().map(range).collect()
}

/// Which motion is tracked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tracked {
    Test,
    /// The motion that steps and girths are learned from, before anything is seen of the test.
    Training,
}

impl Scene {
    /// The scene from recordings, or without any; `frames` of it are tracked.
    pub(super) fn new(folder: Option<&Path>, frames: usize, which: Tracked) -> Outcome<Self> {
        let test = match folder {
            Some(folder) => recorded_combo(folder, RATE_HZ, |_| TURN_RADIUS_M)?,
            None => synthetic_combo(RATE_HZ)?,
        };
        let trained = training(folder)?;
        let sequence = if which == Tracked::Test { test } else { trained.clone() };
        let trained = trained.motion;
        let scale = hppf24_scale::scale(&sequence.motion, &SEGMENTS, Scale::LeastSquares)?;
        let tree = hppf24::tree(scale);
        let mut tracked = sequence.motion.clone();
        tracked.frames.truncate(frames);
        let following = MotionFollowing::default();
        let truth = damped_fit::states(&tree, &tracked, &following)?;
        // Trials for training have the first one's person, of other lengths where there are no recordings.
        let poses = damped_fit::states(&tree, &trained, &following)?;
        let fit_error_m = [error_m(&tree, &truth, &tracked), error_m(&tree, &poses, &trained)];
        let mean = |j: usize| poses.iter().map(|pose| pose[j]).sum::<f64>() / poses.len() as f64;
        Ok(Self {
            mean_pose: (0..tree.dof()).map(mean).collect(),
            girths: Girths::new(&tree, scale, &trained, &poses, RATE_HZ, CAMERA)?,
            name: sequence.name,
            fit_error_m,
            training_frames: poses.len(),
            ranges: ranges(poses, &truth[0])?,
            motion: sequence.motion,
            tree,
            scale,
            truth,
            phases: sequence.phases.into_iter().map(|phase| (phase.name, phase.frames.start)).collect(),
        })
    }

    /// Share of the true poses' coordinates that lie in their ranges.
    pub(super) fn within(&self) -> f64 {
        let inside = |(x, range): (&f64, &Range)| range.axis.difference(range.axis.snap(*x), *x).abs() <= range.width;
        let all: Vec<bool> = self.truth.iter().flat_map(|state| state.iter().zip(&self.ranges).map(inside)).collect();
        all.iter().filter(|inside| **inside).count() as f64 / all.len() as f64
    }

    /// Continues a hash over all that trackers are given and compared with.
    pub(super) fn hash(&self, hash: u64) -> u64 {
        let numbers = self.truth.iter().flatten().copied();
        let grid = self.ranges.iter().flat_map(|range| [range.low, range.high, range.width]);
        let points = self.motion.frames.iter().flatten().flatten().copied();
        let girths = [self.girths.printed, self.girths.fitted].into_iter().flat_map(|of| [of.trunk, of.arms, of.legs]);
        numbers.chain(grid).chain(points).chain(girths).fold(hash, |hash, x| fnv(hash, &x.to_le_bytes()))
    }

    /// Mean distance of the joints from the recorded ones in each frame, both from the middle of the hips, millimetres.
    pub(super) fn relative_error_mm(&self, states: &[Vec<f64>]) -> Vec<f64> {
        let [_, relative] = joint_errors_mm(&points_of_states(&self.tree, states), &self.motion);
        relative
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The body takes up the walker's poses to some centimetres, and moves in no frame by more than its grid's noise may follow.
    #[test]
    fn the_body_follows_the_synthetic_sequence() {
        let scene = Scene::new(None, 40, Tracked::Test).unwrap();
        assert!((0.85..1.15).contains(&scene.scale), "{}", scene.scale);
        assert!(scene.fit_error_m.iter().all(|error| *error < 0.06), "{:?}", scene.fit_error_m);
        assert!(scene.within() > 0.97, "{}", scene.within());
        assert!(scene.ranges.iter().all(|range| range.width < 0.3), "{:?}", scene.ranges);
        let own = scene.relative_error_mm(&scene.truth);
        assert!(own.len() == 40 && own.iter().all(|error| *error < 80.0), "{own:?}");
    }
}
