//! The sequence of the study: CMB before the camera C1, the tracker's body in the subject's size, true poses, and what is learned from other trials.
//!
//! - **Test**: the first 330 frames of CMB at 60 frames a second (walking, 2 s of a join, the start of running). Without recordings the synthetic sequence.
//! - **Body**: HPPF24 with cylinders. One scale, that of least squares of the lengths of limbs, trunk and head against those of the subject.
//! - **True poses**: fitted to the joints frame by frame. Only the first one is told to the trackers.
//! - **Training**: two other walks of the subject, joined and bent as the test is; there is no other trial of running. δ are the standard deviations of the changes of the poses fitted to it. Ranges are nominal ones of the body; ±3 m around the start for the position, where the specification says ±2 m: the subject goes round on a circle 2.4 m across.

use super::Outcome;
use sinew::body::fit::{self, Target, fit_pose};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::body::{KinematicTree, Plan, hppf24};
use sinew::files::fnv;
use sinew::samplers::grid::{self, Axis, LEAST_WIDTH, Width};
use sinew_simulate::cmu::mean_distance;
use sinew_simulate::combo::{Trial, combo, synthetic_combo};
use sinew_simulate::points::{Trajectories, of_states};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::recorded_motion::{recorded, recorded_combo};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Frames per second.
pub(super) const RATE_HZ: f64 = 60.0;
/// Frames that are tracked at most.
pub(super) const FRAMES: usize = 330;
/// Number of the coordinate that wraps.
pub(super) const HEADING: usize = 3;
/// Half the range of the position, metres.
const REACH_M: f64 = 3.0;

/// Trials for training, with the skeleton `07`.
const TRAINING: [&str; 2] = ["07_02", "07_05"];

/// Segments whose lengths tell the scale.
const SEGMENTS: [(&str, &str); 10] = [
    ("MidHip", "Neck"),
    ("Neck", "Head"),
    ("LShoulder", "LElbow"),
    ("RShoulder", "RElbow"),
    ("LElbow", "LWrist"),
    ("RElbow", "RWrist"),
    ("LHip", "LKnee"),
    ("RHip", "RKnee"),
    ("LKnee", "LAnkle"),
    ("RKnee", "RAnkle"),
];

/// The grid of one coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Range {
    pub(super) low: f64,
    pub(super) high: f64,
    /// δ of the coordinate.
    pub(super) width: f64,
    pub(super) axis: Axis,
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
    /// Names of the phases with their first frames.
    pub(super) phases: Vec<(String, usize)>,
}

/// Distances of the ends of [`SEGMENTS`] in a frame.
fn lengths(points: &Trajectories, frame: usize) -> Vec<f64> {
    let at = |name: &str| points.index(name).map_or([f64::NAN; 3], |k| points.frames[frame][k]);
    let length = |&(a, b): &(&str, &str)| {
        let (a, b) = (at(a), at(b));
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    SEGMENTS.iter().map(length).collect()
}

/// The scale of the body that fits best the lengths of a motion's first frame, which are those of all its frames.
fn scale_of(motion: &Trajectories) -> f64 {
    let body = of_states(&hppf24::tree(1.0), &[vec![0.0; 24]]);
    let (own, theirs) = (lengths(&body, 0), lengths(motion, 0));
    let product: f64 = own.iter().zip(&theirs).map(|(a, b)| a * b).sum();
    product / own.iter().map(|a| a * a).sum::<f64>()
}

/// The body upright at the place and with the heading of the first frame, elbows and knees bent the way they bend.
fn upright(motion: &Trajectories) -> Outcome<Vec<f64>> {
    let at = |name: &str| -> Outcome<[f64; 3]> {
        let k = motion.index(name).ok_or(format!("the motion has no {name}"))?;
        Ok(motion.frames.first().ok_or("a motion without a frame")?[k])
    };
    let (hips, left, right) = (at("MidHip")?, at("LHip")?, at("RHip")?);
    let mut pose = vec![0.0; hppf24::ranges().len()];
    pose[..3].copy_from_slice(&hips);
    pose[HEADING] = (right[1] - left[1]).atan2(right[0] - left[0]);
    for (hinge, angle) in [(11, 0.3), (15, 0.3), (19, -0.3), (23, -0.3)] {
        pose[hinge] = angle;
    }
    Ok(pose)
}

/// Poses of the body at the joints of each frame, angles unwrapped.
fn fitted(tree: &KinematicTree, motion: &Trajectories) -> Outcome<Vec<Vec<f64>>> {
    let columns: Vec<Option<usize>> = tree.points().iter().map(|point| motion.index(&point.name)).collect();
    let plan = Plan::with_all_points(tree);
    let mut states: Vec<Vec<f64>> = vec![];
    for frame in &motion.frames {
        let targets: Vec<Option<Target>> =
            columns.iter().map(|k| k.map(|k| Target { position: frame[k], weight: 1.0 })).collect();
        let last = states.last();
        let start = match last {
            Some(last) => last.clone(),
            None => upright(motion)?,
        };
        let mut pose = fit_pose(&plan, &targets, &start, &fit::Config::default()).pose;
        for (angle, before) in pose.iter_mut().zip(&start).skip(HEADING) {
            *angle -= TAU * ((*angle - before) / TAU).round();
        }
        states.push(pose);
    }
    Ok(states)
}

fn error_m(tree: &KinematicTree, states: &[Vec<f64>], motion: &Trajectories) -> f64 {
    mean_distance(&of_states(tree, states).select(&EVALUATION_JOINTS), &motion.select(&EVALUATION_JOINTS))
}

/// A motion for training that is none of the test's.
fn training(folder: Option<&Path>) -> Outcome<Trajectories> {
    let trials: Vec<Trial> = match folder {
        Some(folder) => TRAINING
            .iter()
            .map(|&name| -> Outcome<Trial> {
                let motion = folder.join(format!("{name}.amc"));
                let motion = recorded(&motion, &folder.join("07.asf"), RATE_HZ)?;
                Ok(Trial { name: name.into(), motion, is_locomotion: true })
            })
            .collect::<Outcome<_>>()?,
        None => [1.3, 0.9]
            .map(|stride_s| {
                let walker = Walker::new(Gait { still_s: 0.0, stride_s, ..Gait::default() });
                let motion = of_states(&walker.body, &walker_states(&walker, RATE_HZ));
                Trial { name: format!("walk of {stride_s} s"), motion, is_locomotion: true }
            })
            .into(),
    };
    Ok(combo("training", &trials, RATE_HZ)?.motion)
}

/// Steps learned from training, ranges around the start.
fn ranges(states: Vec<Vec<f64>>, start: &[f64]) -> Outcome<Vec<Range>> {
    let wraps: Vec<bool> = (0..start.len()).map(|j| j == HEADING).collect();
    let learned = grid::train(&[states], &wraps, Width::default())?;
    let range = |(j, learned): (usize, &Axis)| {
        let [low, high] = match hppf24::ranges()[j] {
            Some(range) => range,
            None if j == HEADING => [-PI, PI],
            None => [start[j] - REACH_M, start[j] + REACH_M],
        };
        let width = learned.width().max(LEAST_WIDTH);
        Ok(Range { low, high, width, axis: Axis::new(low, high, width, wraps[j])? })
    };
    learned.iter().enumerate().map(range).collect()
}

impl Scene {
    /// The scene from recordings, or without any; `frames` of it are tracked.
    pub(super) fn new(folder: Option<&Path>, frames: usize) -> Outcome<Self> {
        let sequence = match folder {
            Some(folder) => recorded_combo(folder, RATE_HZ)?,
            None => synthetic_combo(RATE_HZ)?,
        };
        let scale = scale_of(&sequence.motion);
        let tree = hppf24::tree(scale);
        let mut tracked = sequence.motion.clone();
        tracked.frames.truncate(frames);
        let truth = fitted(&tree, &tracked)?;
        let trained = training(folder)?;
        // Trials for training have the first one's person, of other lengths where there are no recordings.
        let poses = fitted(&tree, &trained)?;
        let fit_error_m = [error_m(&tree, &truth, &tracked), error_m(&tree, &poses, &trained)];
        Ok(Self {
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

    /// Continues a hash over all that trackers are told and compared with.
    pub(super) fn hash(&self, hash: u64) -> u64 {
        let numbers = self.truth.iter().flatten().copied();
        let grid = self.ranges.iter().flat_map(|range| [range.low, range.high, range.width]);
        let points = self.motion.frames.iter().flatten().flatten().copied();
        numbers.chain(grid).chain(points).fold(hash, |hash, x| fnv(hash, &x.to_le_bytes()))
    }

    /// Mean distance of the joints from the recorded ones, both about the middle of the hips, which counts as none, metres.
    pub(super) fn relative_error_m(&self, states: &[Vec<f64>]) -> Vec<f64> {
        let found = of_states(&self.tree, states).select(&EVALUATION_JOINTS);
        let truth = self.motion.select(&EVALUATION_JOINTS);
        let hips = found.index("MidHip").unwrap_or(0);
        let error = |(found, truth): (&Vec<[f64; 3]>, &Vec<[f64; 3]>)| {
            let offset = [0, 1, 2].map(|k: usize| found[hips][k] - truth[hips][k]);
            let distance =
                |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k] - offset[k]).powi(2)).sum::<f64>().sqrt();
            found.iter().zip(truth).map(distance).sum::<f64>() / (found.len() - 1) as f64
        };
        found.frames.iter().zip(&truth.frames).map(error).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The body takes up the walker's poses to some centimetres, and moves in no frame by more than its grid's noise may follow.
    #[test]
    fn the_body_follows_the_synthetic_sequence() {
        let scene = Scene::new(None, 40).unwrap();
        assert!((0.85..1.15).contains(&scene.scale), "{}", scene.scale);
        assert!(scene.fit_error_m.iter().all(|error| *error < 0.06), "{:?}", scene.fit_error_m);
        assert!(scene.within() > 0.97, "{}", scene.within());
        assert!(scene.ranges.iter().all(|range| range.width < 0.3), "{:?}", scene.ranges);
        let own = scene.relative_error_m(&scene.truth);
        assert!(own.len() == 40 && own.iter().all(|error| *error < 0.08), "{own:?}");
    }
}
