//! A walk as HPPF24 in the person's size makes it, fitted to the joints frame by frame.
//!
//! The walk that is tracked is 07_01 of the CMU database, and what is tuned is tuned on 07_02 and 07_05 of the same person. Without the recordings the synthetic walker takes their place, with another stride for tuning.

use crate::papers::masked_scene::SEGMENTS;
use crate::support::outcome::Outcome;
use sinew::body::{KinematicTree, hppf24};
use sinew::files::{FNV_START, fnv};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_motion::damped_fit::{self, MotionFollowing};
use sinew_motion::hppf24_scale::{self, Scale};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::evaluation::joint_errors::joint_errors_mm;
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

/// Twists of straight limbs stay where they are, and joints lag by less than a millimetre.
const FOLLOWING: MotionFollowing = MotionFollowing { damping: 1e-3, first_refits: 20 };

impl Walk {
    /// Fits the body.
    pub(super) fn new(name: &str, motion: Trajectories) -> Outcome<Self> {
        let scale = hppf24_scale::scale(&motion, &SEGMENTS[2..], Scale::Medians)?;
        let tree = hppf24::tree(scale);
        let names: Vec<&str> = tree.points().iter().map(|point| point.name.as_str()).collect();
        let seen = motion.select(&names);
        if seen.names != names {
            return Err("a joint of evaluation is missing".into());
        }
        let states = damped_fit::states(&tree, &seen, &FOLLOWING)?;
        Ok(Self { name: name.into(), motion, scale, tree, states })
    }

    /// Mean distance of the joints of states from the motion's over the frames from the first given one on: as they are, and from the pelvis, the other 14 joints; millimetres, frame by frame.
    pub(super) fn errors(&self, states: &[Vec<f64>], first: usize) -> [Vec<f64>; 2] {
        let Trajectories { names, frames } = &self.motion;
        let truth = Trajectories { names: names.clone(), frames: frames[first..].to_vec() };
        joint_errors_mm(&points_of_states(&self.tree, states), &truth)
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
                Walk::new(name, points_of_states(&walker.body, &walker_states(&walker, RATE_HZ)))
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
