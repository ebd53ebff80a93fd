//! Hamiltonian Monte Carlo keeps its target, and planted faults are seen (H6, H7, H10; `long-run`, `step-size sweep`, `divergent stays`, `adaptation-frozen`, `target acceptance`), in reduced size.

use sinew_tests::camera_point::CameraPoint;
use sinew_tests::finding::demand;
use sinew_tests::kept_targets::{
    curvature_of_state, exact_starts, long_run, rejections, reversal, sweep, tuned_acceptance, walls,
};

/// H6. 66 statistics: false alarm 2e-3, most of it from 13 Kolmogorov–Smirnov tests at 1e-4.
#[test]
fn one_update_leaves_exact_draws_exact() {
    demand(&exact_starts(CameraPoint::stored().as_ref(), 6000, 6));
}

/// H7.
#[test]
fn curvature_of_the_state_is_detected() {
    let [right, wrong] = curvature_of_state(12_500, 7);
    demand(&right);
    let seen: Vec<String> =
        wrong.iter().filter(|f| !f.holds()).map(|f| format!("{}: {}", f.name, f.statistic)).collect();
    println!("detected by {seen:?}");
    assert!(!seen.is_empty(), "the planted fault passed: {wrong:?}");
    let [kept, lost] = reversal();
    assert!(kept < 1e-12 && lost > 1e-3, "reversal: {kept} and, with the fault, {lost}");
}

/// H10.
#[test]
fn dropped_rejections_are_detected() {
    let [right, wrong, part] = rejections(250, 200, 10);
    println!("without rejected states: {wrong:?}");
    assert!(!wrong.holds(), "the planted fault passed: {wrong:?}");
    demand(&[right, part]);
}

#[test]
fn a_long_run_has_the_variance_of_its_target() {
    demand(&[long_run(6000, 28)]);
}

/// 16 statistics at |z| < 4.5.
#[test]
fn every_step_size_keeps_the_variance() {
    demand(&sweep(30, 29));
}

#[test]
fn walls_are_never_crossed_and_change_nothing_between_them() {
    demand(&walls(250, 20, 30));
}

#[test]
fn the_tuned_acceptance_is_realised_by_frozen_steps() {
    demand(&tuned_acceptance(500, 31));
}
