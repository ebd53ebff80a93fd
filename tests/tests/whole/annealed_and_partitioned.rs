//! The annealed and the partitioned tracker against laws and exact filters, in reduced size: weighted resampling (R6), noise of layers (A6), partitions (A7–A9), crossover (A11), eight modes (E7), `partitioned-exact`. Exact ones (A1, A12) are in `crates/sinew-tracking/tests/searches.rs`, those of the exponent (A2–A5) in
//! `crates/sinew-samplers/tests/temperature.rs`.

use sinew_tests::annealing_laws::{collapse_on_the_depth_flip, marginals_under_crossover, noise_of_layers};
use sinew_tests::depth_flip::Arm;
use sinew_tests::finding::demand;
use sinew_tests::partitioned_laws::{Importance, agreement, particles_needed, represents_the_same, without_correction};
use sinew_tests::size::Size;

/// Weighted resampling is unbiased (R6). 12 scores at |z| < 4.5: false alarm 8e-5.
#[test]
fn weighted_resampling_represents_the_same() {
    demand(&represents_the_same(1, Size::Reduced));
}

/// The partitioned filter against exact moments (A7). 52 scores at |z| < 4.5: false alarm 4e-4.
#[test]
fn one_frame_of_the_partitioned_filter_is_exact_whatever_its_importance() {
    for importance in [Importance::Product, Importance::Right, Importance::Wrong, Importance::Whole] {
        demand(&agreement(true, importance, 1, Size::Reduced, 2));
    }
}

/// `partitioned-exact`. 78 scores at |z| < 4: false alarm 5e-3.
#[test]
fn the_partitioned_filter_is_the_joint_filter() {
    for coupled in [false, true] {
        for importance in [Importance::Product, Importance::Wrong, Importance::Whole] {
            demand(&agreement(coupled, importance, 4, Size::Reduced, 3));
        }
    }
}

/// Negative control: weights left out (A8).
#[test]
fn without_its_weights_weighted_resampling_is_seen_to_fail() {
    for importance in [Importance::Right, Importance::Wrong] {
        let [with, without] = without_correction(importance, Size::Reduced, 4);
        println!("{importance:?}: largest |z| {with:.2} with the weights, {without:.2} without");
        assert!(with < 4.5 && without > 4.5, "{importance:?}: {with} and {without}");
    }
}

/// Growth with the number of parts (A9).
#[test]
fn partitions_need_particles_for_one_part_at_a_time() {
    demand(&particles_needed(5, Size::Reduced));
}

/// Noise of layers (A6).
#[test]
fn the_noise_of_a_layer_shrinks_with_the_survival_rates() {
    demand(&noise_of_layers(6));
}

/// Crossover (A11). 8 scores at |z| < 4.5: false alarm 5e-5.
#[test]
fn crossover_keeps_marginals() {
    demand(&marginals_under_crossover(7, Size::Reduced));
}

/// Collapse of the annealed filter on eight modes (second half of E7).
#[test]
fn the_annealed_filter_collapses_on_eight_modes() {
    let Some(arm) = Arm::stored() else { return };
    demand(&collapse_on_the_depth_flip(&arm, 10, 9));
}
