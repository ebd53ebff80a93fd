//! Frame rates of the study, and the trials of its pilot, which leaves its own two out of training.

use crate::papers::recorded_trials::{BALANCING, Part, Recording, TRAINING, cmu, subject_35};

/// Frames per second that are tracked.
pub(super) const RATE_HZ: f64 = 20.0;
/// Frames per second from which all phases of the tracked rate are taken.
pub(super) const WORKING_HZ: f64 = 120.0;

/// Trials of training that the pilot tracks: a walk, a run and half of balancing, and all three joined as in CMB.
pub(super) const PILOT: [Recording; 3] = [cmu("07_05", "07"), subject_35("run_03"), BALANCING.taking(Part::FirstHalf)];

/// What the pilot learns from: of training what it does not track.
pub(super) fn pilot_training() -> Vec<Recording> {
    let untracked = |trial: Recording| match PILOT.iter().find(|tracked| tracked.name == trial.name) {
        None => Some(trial),
        Some(tracked) if tracked.part == Part::FirstHalf => Some(trial.taking(Part::SecondHalf)),
        Some(_) => None,
    };
    TRAINING.into_iter().filter_map(untracked).collect()
}
