//! The samplers against `sinew-invariance`, in reduced size and with fixed seeds. False alarms: 1e-6 a report.

use sinew_invariance::Report;
use sinew_tests::resampling_laws;
use sinew_tests::sampler_invariance as samplers;
use sinew_tests::size::Size;

fn all_hold(reports: &[Report]) {
    assert!(!reports.is_empty());
    reports.iter().for_each(Report::assert_holds);
}

#[test]
fn hmc_keeps_every_target() {
    all_hold(&samplers::hmc_exact_starts(1, Size::Reduced));
}

#[test]
fn hmc_keeps_its_target_with_a_dense_metric_and_before_cameras() {
    all_hold(&samplers::dense_and_camera_exact_starts(1, Size::Reduced));
}

#[test]
fn no_u_turn_keeps_every_target() {
    all_hold(&samplers::nuts_exact_starts(1, Size::Reduced));
}

#[test]
fn jumps_keep_every_target() {
    all_hold(&samplers::jump_exact_starts(1, Size::Reduced));
}

#[test]
fn hmc_keeps_its_target_at_any_step_size() {
    all_hold(&samplers::step_size_sweep(1, Size::Reduced));
}

#[test]
fn hmc_keeps_shapes() {
    all_hold(&samplers::shapes(1, Size::Reduced));
}

#[test]
fn hmc_is_in_detailed_balance() {
    all_hold(&samplers::ranks_in_paths(1, Size::Reduced));
}

#[test]
fn samplers_reach_their_targets() {
    all_hold(&samplers::long_runs(1, Size::Reduced));
}

#[test]
fn leapfrog_is_reversible_keeps_volume_and_is_of_second_order() {
    all_hold(&samplers::integrator(1, Size::Reduced));
}

#[test]
fn every_resampling_scheme_keeps_its_law() {
    all_hold(&resampling_laws::every_scheme(1, Size::Reduced));
}
