//! Faults of the step sizes (H7), dropped rejections (H10), walls and frozen tuning, in reduced size and with fixed seeds.

use sinew_tests::checks::faults;
use sinew_tests::finding::demand;
use sinew_tests::frozen_tuning::tuned_acceptance;
use sinew_tests::size::Size;
use sinew_tests::walls::walls;

#[test]
fn kernels_with_planted_faults_are_seen() {
    for outcome in faults(1, Size::Reduced) {
        println!("{}: {}", outcome.name, outcome.worst);
        assert!(outcome.holds, "{}: {}", outcome.name, outcome.worst);
    }
}

#[test]
fn walls_are_never_crossed_and_change_nothing_between_them() {
    demand(&walls(250, 20, 30));
}

#[test]
fn the_tuned_acceptance_is_realised_by_frozen_steps() {
    demand(&tuned_acceptance(500, 31));
}
