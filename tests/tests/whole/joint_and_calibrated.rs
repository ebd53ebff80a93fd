//! Joint distributions (J1) and simulation-based calibration (J2): the samplers against simulators of states and observations; with planted bugs as negative controls. Seeds are fixed, false alarms 1e-6 a report.

use sinew_tests::calibrated_samplers as calibrated;
use sinew_tests::filter_calibration::normalised_errors;
use sinew_tests::finding::demand;
use sinew_tests::joint_distribution::{arm, linear, right};
use sinew_tests::planted_hmc::Bug;
use sinew_tests::size::Size;

#[test]
fn hmc_has_the_joint_distribution_of_the_simulator() {
    right(1, Size::Reduced).iter().for_each(|report| report.assert_holds());
}

#[test]
fn another_noise_level_than_the_simulators_is_seen() {
    arm(1, Size::Reduced, 0.8).assert_fails();
    linear(1, Size::Reduced, Bug::None, 0.8).assert_fails();
}

#[test]
fn a_missing_half_kick_and_a_missing_accept_step_are_seen() {
    for bug in [Bug::MissingHalfKick, Bug::NoAcceptStep, Bug::StepByPosition] {
        linear(1, Size::Reduced, bug, 1.0).assert_fails();
    }
}

/// Why gradients have tests of their own.
#[test]
fn a_wrong_gradient_passes_tests_of_invariance() {
    linear(1, Size::Reduced, Bug::WrongGradient, 1.0).assert_holds();
}

#[test]
fn intervals_of_the_samplers_are_calibrated() {
    calibrated::hmc(1, Size::Reduced).0.assert_holds();
    calibrated::tempered(1, Size::Reduced).0.assert_holds();
    calibrated::particle_filter(1, Size::Reduced).0.assert_holds();
}

#[test]
fn a_search_is_not_calibrated() {
    calibrated::annealed(1, Size::Reduced).0.assert_fails();
    calibrated::annealed_filter(1, Size::Reduced).0.assert_fails();
}

/// Calibration of filters (J3). Three scores at |z| < 4.
#[test]
fn filters_err_as_much_as_they_say() {
    demand(&normalised_errors(1, Size::Reduced));
}
