//! A walk as the tracker's body makes it: HPPF24 in the person's size, fitted to the joints frame by frame.
//!
//! The walk that is tracked is 07_01 of the CMU database, and what is tuned is tuned on 07_02 and 07_05 of the same person. Without the recordings the synthetic walker takes their place, with another stride for tuning.

use super::Outcome;
use sinew::body::fit::{Config, Target, fit_pose};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::body::{KinematicTree, Plan, hppf24};
use sinew::files::{FNV_START, fnv};
use sinew_simulate::points::{Trajectories, of_states};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::recorded_motion::recorded;
use std::path::Path;

/// Frames per second.
pub(super) const RATE_HZ: f64 = 20.0;

/// A motion and the states of the body that follows it.
pub(super) struct Walk {
    pub(super) name: String,
    pub(super) motion: Trajectories,
    /// Size of the body, one for an adult of 1.75 m.
    pub(super) scale: f64,
    pub(super) tree: KinematicTree,
    pub(super) states: Vec<Vec<f64>>,
}

/// Segments whose lengths tell the size.
const LIMBS: [(&str, &str); 8] = [
    ("LShoulder", "LElbow"),
    ("RShoulder", "RElbow"),
    ("LElbow", "LWrist"),
    ("RElbow", "RWrist"),
    ("LHip", "LKnee"),
    ("RHip", "RKnee"),
    ("LKnee", "LAnkle"),
    ("RKnee", "RAnkle"),
];

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Sum of the limbs' median lengths, metres.
fn limbs(motion: &Trajectories) -> Outcome<f64> {
    let mut sum = 0.0;
    for (from, to) in LIMBS {
        let [a, b] = [from, to].map(|name| motion.index(name).ok_or(format!("the motion has no {name}")));
        let (a, b) = (a?, b?);
        let mut all: Vec<f64> = motion.frames.iter().map(|frame| distance(frame[a], frame[b])).collect();
        all.sort_by(f64::total_cmp);
        sum += all[all.len() / 2];
    }
    Ok(sum)
}

/// Weight of the squared change of a coordinate from frame to frame: twists of straight limbs stay where they are, and joints lag by less than a millimetre.
const DAMPING: f64 = 1e-3;

impl Walk {
    /// Fits the body.
    pub(super) fn new(name: &str, motion: Trajectories) -> Outcome<Self> {
        let unit = hppf24::tree(1.0);
        let scale = limbs(&motion)? / limbs(&of_states(&unit, &[vec![0.0; unit.dof()]]))?;
        let tree = hppf24::tree(scale);
        let plan = Plan::with_all_points(&tree);
        let names: Vec<&str> = tree.points().iter().map(|point| point.name.as_str()).collect();
        let seen = motion.select(&names);
        if seen.names != names {
            return Err("a joint of evaluation is missing".into());
        }
        let config = Config { damping: DAMPING, ..Config::default() };
        let mut states: Vec<Vec<f64>> = Vec::with_capacity(seen.frames.len());
        for frame in &seen.frames {
            let targets: Vec<_> = frame.iter().map(|&position| Some(Target { position, weight: 1.0 })).collect();
            let start = states.last().cloned().unwrap_or_else(|| upright(frame, &names));
            let mut pose = fit_pose(&plan, &targets, &start, &config).pose;
            if states.is_empty() {
                // The first frame has no frame before it to stay near.
                for _ in 0..20 {
                    pose = fit_pose(&plan, &targets, &pose, &config).pose;
                }
            }
            states.push(pose);
        }
        Ok(Self { name: name.into(), motion, scale, tree, states })
    }

    /// Mean distance of the joints of states from the motion's over the frames from the first given one on: as they are, and from the pelvis, the other 14 joints; millimetres, frame by frame.
    pub(super) fn errors(&self, states: &[Vec<f64>], first: usize) -> [Vec<f64>; 2] {
        let found = of_states(&self.tree, states).select(&EVALUATION_JOINTS);
        let truth = self.motion.select(&EVALUATION_JOINTS);
        let pairs = || found.frames.iter().zip(&truth.frames[first..]);
        let absolute = pairs().map(|(a, b)| a.iter().zip(b).map(|(a, b)| 1e3 * distance(*a, *b)).sum::<f64>() / 15.0);
        let moved = |frame: &[[f64; 3]], k: usize| [0, 1, 2].map(|i| frame[k][i] - frame[0][i]);
        let relative =
            pairs().map(|(a, b)| (1..15).map(|k| 1e3 * distance(moved(a, k), moved(b, k))).sum::<f64>() / 14.0);
        [absolute.collect(), relative.collect()]
    }

    /// Half of the largest change of each coordinate from frame to frame.
    pub(super) fn half_of_largest_changes(&self) -> Vec<f64> {
        let change = |j: usize| self.states.windows(2).map(|pair| (pair[1][j] - pair[0][j]).abs()).fold(0.0, f64::max);
        (0..self.tree.dof()).map(|j| 0.5 * change(j)).collect()
    }

    /// Continues a hash with the states.
    pub(super) fn hash(&self, hash: u64) -> u64 {
        self.states.iter().flatten().fold(hash, |hash, x| fnv(hash, &x.to_bits().to_le_bytes()))
    }
}

/// Upright at the pelvis, turned as the hips are, elbows and knees slightly bent.
fn upright(frame: &[[f64; 3]], names: &[&str]) -> Vec<f64> {
    let at = |name: &str| names.iter().position(|other| *other == name).map_or([0.0; 3], |k| frame[k]);
    let ([left, right], pelvis) = (["LHip", "RHip"].map(at), at("MidHip"));
    let mut state = vec![0.0; 24];
    state[..3].copy_from_slice(&pelvis);
    // At a heading of zero the right side is at +x.
    state[3] = (right[1] - left[1]).atan2(right[0] - left[0]);
    for (elbow, knee) in [(11, 19), (15, 23)] {
        (state[elbow], state[knee]) = (0.3, -0.3);
    }
    state
}

/// What is tracked and what it is tuned on.
pub(super) struct Walks {
    pub(super) test: Walk,
    /// Standard deviations P of the base diffusion: half of the largest change of each coordinate in the training walks.
    pub(super) sd: Vec<f64>,
}

/// Least standard deviation of the diffusion, metres and radians.
const LEAST_SD: f64 = 0.002;

impl Walks {
    /// Reads or makes the walks.
    pub(super) fn new(data: &Path) -> Outcome<Self> {
        let folder = data.join("cmu_amc");
        let (test, training) = if folder.is_dir() {
            let read = |name: &str| -> Outcome<Walk> {
                let path = folder.join(format!("{name}.amc"));
                Walk::new(name, recorded(&path, &folder.join("07.asf"), RATE_HZ)?)
            };
            (read("07_01")?, vec![read("07_02")?, read("07_05")?])
        } else {
            let made = |name: &str, stride_s: f64| -> Outcome<Walk> {
                let walker = Walker::new(Gait { still_s: 0.0, stride_s, duration_s: 4.0, ..Gait::default() });
                Walk::new(name, of_states(&walker.body, &walker_states(&walker, RATE_HZ)))
            };
            (made("synthetic walk", 1.1)?, vec![made("synthetic walk, slower", 1.2)?])
        };
        let mut sd = vec![LEAST_SD; test.tree.dof()];
        for walk in &training {
            sd.iter_mut().zip(walk.half_of_largest_changes()).for_each(|(sd, half)| *sd = sd.max(half));
        }
        Ok(Self { test, sd })
    }

    /// Hash of everything that is tracked.
    pub(super) fn hash(&self) -> u64 {
        self.sd.iter().fold(self.test.hash(FNV_START), |hash, x| fnv(hash, &x.to_bits().to_le_bytes()))
    }
}
