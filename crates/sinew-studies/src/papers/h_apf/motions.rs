//! What the study learns from and tracks. Walks and runs go round, as the person of the paper's figure 1 does.

use crate::papers::recorded_trials::{BALANCING, Part, Recording, TEST_TRIALS, cmu, subject_35};
use std::ops::Range;

/// Frames per second that are tracked, and of the comparison of rates.
pub(super) const RATE_HZ: f64 = 15.0;
pub(super) const FAST_HZ: f64 = 60.0;

/// What the models of walking learn from: two people.
pub(super) const WALKS: [Recording; 4] =
    [cmu("07_02", "07"), cmu("07_10", "07"), subject_35("walk_01"), subject_35("walk_05")];

/// Of several motions: walks, runs, and half of balancing.
pub(super) const SEVERAL: [Recording; 6] = [
    cmu("07_02", "07"),
    subject_35("walk_01"),
    subject_35("run_01"),
    subject_35("run_03"),
    subject_35("run_05"),
    BALANCING.taking(Part::FirstHalf),
];

/// Of walking at the higher rate: as many rows hold half of a walk of each person.
pub(super) const FAST_WALKS: [Recording; 2] =
    [cmu("07_02", "07").taking(Part::FirstHalf), subject_35("walk_01").taking(Part::FirstHalf)];

/// Trials of training that no model learns from: what reconstruction is tried on, and the walk of the pilot.
pub(super) const HELD_OUT_WALKS: [Recording; 3] = [PILOT, cmu("07_08", "07"), subject_35("walk_03")];
pub(super) const HELD_OUT_SEVERAL: [Recording; 3] = [PILOT, subject_35("run_02"), BALANCING.taking(Part::SecondHalf)];
pub(super) const PILOT: Recording = cmu("07_05", "07");

/// Places of walks and runs among [`TEST_TRIALS`].
pub(super) const TEST_WALKS: Range<usize> = 0..8;
pub(super) const TEST_RUNS: Range<usize> = 8..13;

/// Test walks that are tracked at both rates.
pub(super) const BOTH_RATES: [usize; 4] = [1, 2, 4, 7];

/// Pairs of test walks that are joined, for a sequence long enough to be lost in and found again.
pub(super) const RECOVERED: [[usize; 2]; 4] = [[1, 2], [4, 7], [6, 5], [7, 3]];
/// Frames of such a sequence: six seconds.
pub(super) const RECOVERY_FRAMES: usize = 90;
/// First frame of the disturbance, number of blank frames (half a second), and number of frames within which the person is to be found (two seconds): all in the first walk.
pub(super) const DISTURBED: usize = 15;
pub(super) const BLANK_FRAMES: usize = 8;
pub(super) const FOUND_WITHIN: usize = 30;

/// Frames of a single trial at most: ten seconds.
pub(super) const LONGEST: usize = 150;

/// A test trial.
pub(super) const fn test(number: usize) -> Recording {
    TEST_TRIALS[number]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::recorded_trials::TRAINING;

    #[test]
    fn nothing_that_is_tracked_or_held_out_is_learned_from() {
        let learned: Vec<&str> = WALKS.iter().chain(&SEVERAL).chain(&FAST_WALKS).map(|trial| trial.name).collect();
        assert!(learned.iter().all(|name| TRAINING.iter().any(|trial| trial.name == *name)));
        assert!(TEST_TRIALS.iter().all(|trial| !learned.contains(&trial.name)));
        let whole = HELD_OUT_WALKS.iter().chain(&HELD_OUT_SEVERAL).filter(|trial| trial.part == Part::Whole);
        assert!(whole.into_iter().all(|trial| !learned.contains(&trial.name)));
        assert!(TEST_WALKS.clone().all(|k| test(k).name.starts_with("07") || test(k).name.starts_with("walk")));
        assert!(TEST_RUNS.clone().all(|k| test(k).name == "09_06" || test(k).name.starts_with("run")));
    }
}
