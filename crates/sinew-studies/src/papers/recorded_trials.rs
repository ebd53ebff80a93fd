//! Recorded trials that studies of trackers learn from and track.
//!
//! Training: walks and runs of two people and one trial of balancing. Trials of subject 35 have 30 frames a second, all others 120. A trial that is tracked is never learned from.

use crate::support::outcome::Outcome;
use sinew::formats::{amc, asf};
use sinew_body::points::Trajectories;
use sinew_motion::cmu;
use sinew_tests::combo::{Sequence, Trial, combo, comfortable_radius_m};
use std::path::Path;

/// A trial: its folder, name, skeleton and frame rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Recording {
    folder: &'static str,
    pub(super) name: &'static str,
    skeleton: &'static str,
    recorded_hz: f64,
    pub(super) part: Part,
}

/// How much of a trial is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    Whole,
    FirstHalf,
    SecondHalf,
}

pub(super) const fn cmu(name: &'static str, skeleton: &'static str) -> Recording {
    Recording { folder: "cmu_amc", name, skeleton, recorded_hz: 120.0, part: Part::Whole }
}

pub(super) const fn subject_35(name: &'static str) -> Recording {
    Recording { folder: "cmu_amc_35", name, skeleton: "35", recorded_hz: 30.0, part: Part::Whole }
}

/// What is learned from.
pub(super) const TRAINING: [Recording; 23] = [
    cmu("07_02", "07"),
    cmu("07_05", "07"),
    cmu("07_06", "07"),
    cmu("07_08", "07"),
    cmu("07_10", "07"),
    subject_35("walk_01"),
    subject_35("walk_02"),
    subject_35("walk_03"),
    subject_35("walk_04"),
    subject_35("walk_05"),
    subject_35("walk_06"),
    subject_35("walk_07"),
    subject_35("walk_08"),
    subject_35("walk_09"),
    subject_35("walk_10"),
    subject_35("walk_11"),
    subject_35("walk_12"),
    subject_35("run_01"),
    subject_35("run_02"),
    subject_35("run_03"),
    subject_35("run_04"),
    subject_35("run_05"),
    BALANCING,
];

/// The only trial of training that goes nowhere.
pub(super) const BALANCING: Recording = cmu("49_19", "49");

/// The test walk of the tables.
pub(super) const TEST_WALK: Recording = cmu("07_01", "07");

/// All test trials: walks, runs and balancing.
pub(super) const TEST_TRIALS: [Recording; 14] = [
    TEST_WALK,
    cmu("07_04", "07"),
    cmu("07_07", "07"),
    cmu("07_09", "07"),
    subject_35("walk_13"),
    subject_35("walk_14"),
    subject_35("walk_15"),
    subject_35("walk_16"),
    cmu("09_06", "09"),
    subject_35("run_06"),
    subject_35("run_07"),
    subject_35("run_08"),
    subject_35("run_09"),
    cmu("49_18", "49"),
];

/// People and motions that training lacks.
pub(super) const UNSEEN: [Recording; 2] = [cmu("01_01", "01"), cmu("135_06", "135")];

impl Recording {
    /// The trial, or a half of it.
    pub(super) const fn taking(self, part: Part) -> Self {
        Self { part, ..self }
    }

    fn is_balancing(&self) -> bool {
        self.name == BALANCING.name
    }

    /// Joints at a rate.
    pub(super) fn joints(&self, data: &Path, rate_hz: f64) -> Outcome<Trajectories> {
        let folder = data.join(self.folder);
        let [skeleton, motion] =
            [format!("{}.asf", self.skeleton), format!("{}.amc", self.name)].map(|f| folder.join(f));
        let skeleton = asf::read(&skeleton.display().to_string(), &std::fs::read_to_string(skeleton)?)?;
        let motion = amc::read(&motion.display().to_string(), &std::fs::read_to_string(motion)?, &skeleton)?;
        let mut joints = cmu::joints(&skeleton, &motion, self.recorded_hz / rate_hz);
        let half = joints.frames.len() / 2;
        match self.part {
            Part::Whole => {}
            Part::FirstHalf => joints.frames.truncate(half),
            Part::SecondHalf => drop(joints.frames.drain(..half)),
        }
        Ok(joints)
    }

    /// Joints at a rate, of a motion that goes round as CMB does.
    pub(super) fn bent(&self, data: &Path, rate_hz: f64) -> Outcome<Trajectories> {
        Ok(joined(&[*self], data, rate_hz)?.motion)
    }
}

/// Trials as one motion that goes round.
pub(super) fn joined(trials: &[Recording], data: &Path, rate_hz: f64) -> Outcome<Sequence> {
    let trial = |recording: &Recording| -> Outcome<Trial> {
        let motion = recording.joints(data, rate_hz)?;
        let turn_radius_m = (!recording.is_balancing()).then(|| comfortable_radius_m(&motion, rate_hz));
        Ok(Trial { name: recording.name.into(), motion, turn_radius_m })
    };
    let trials = trials.iter().map(trial).collect::<Outcome<Vec<Trial>>>()?;
    Ok(combo("all three, going round", &trials, rate_hz)?)
}
