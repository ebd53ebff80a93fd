//! The survival diagnostic and the exponent that is solved from it: A2 to A5.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_samplers::temperature::{MOST, exponent};
use sinew_samplers::weights::{effective_number, normalise};

/// Log weights of a Gaussian in ten dimensions: χ² halves.
fn log_weights(seed: u64, count: usize) -> Vec<f64> {
    let mut rng = Stage::new(seed, "log weights").whole();
    let mut normals = [Block::ZERO; 10];
    let draw = |_| {
        rng.fill_normal(Isa::best(), &mut normals);
        -3.0 * normals.iter().map(|b| b.0[0] * b.0[0]).sum::<f64>()
    };
    (0..count).map(draw).collect()
}

fn weights(log_weights: &[f64], beta: f64) -> Vec<f64> {
    let mut weights = vec![];
    normalise(&log_weights.iter().map(|l| beta * l).collect::<Vec<_>>(), &mut weights).expect("weights");
    weights
}

fn survivors(log_weights: &[f64], beta: f64) -> f64 {
    effective_number(&weights(log_weights, beta))
}

/// A2.
#[test]
fn the_solved_exponent_leaves_the_wanted_part() {
    for seed in 0..20 {
        for survival in [0.05, 0.3, 0.5, 0.9, 0.99] {
            let l = log_weights(seed, 200);
            let beta = exponent(&l, survival, MOST).expect("weights");
            assert!((survivors(&l, beta) / 200.0 - survival).abs() < 1e-6, "seed {seed}, {survival}: {beta}");
        }
    }
}

/// A3: D falls, and as d log D / dβ = 2 (E_β[l] − E_2β[l]) says.
#[test]
fn fewer_survive_a_larger_exponent() {
    for seed in 0..5 {
        let l = log_weights(seed, 200);
        let mean = |beta: f64| -> f64 { weights(&l, beta).iter().zip(&l).map(|(w, l)| w * l).sum() };
        let mut before = survivors(&l, 0.0);
        assert!((before - 200.0).abs() < 1e-9);
        for step in 1..200 {
            let beta = 0.01 * f64::from(step);
            let now = survivors(&l, beta);
            assert!(now <= before + 1e-12, "seed {seed}, β = {beta}: {now} after {before}");
            before = now;
            let numeric = (survivors(&l, beta + 1e-6).ln() - survivors(&l, beta - 1e-6).ln()) / 2e-6;
            let formula = 2.0 * (mean(beta) - mean(2.0 * beta));
            assert!((numeric - formula).abs() < 1e-6 * formula.abs().max(1.0), "seed {seed}: {numeric} for {formula}");
        }
    }
}

/// A4.
#[test]
fn the_exponent_does_not_know_the_zero_of_the_log_weights_and_scales_with_their_unit() {
    for seed in 0..20 {
        let l = log_weights(seed, 200);
        let beta = exponent(&l, 0.5, MOST).expect("weights");
        for constant in [-1e3, 0.1, 77.0] {
            let moved: Vec<f64> = l.iter().map(|l| l + constant).collect();
            let found = exponent(&moved, 0.5, MOST).expect("weights");
            assert!((found / beta - 1.0).abs() < 1e-9, "seed {seed}, + {constant}: {found} for {beta}");
        }
        for factor in [1e-3, 0.3, 7.0, 1e4] {
            let scaled: Vec<f64> = l.iter().map(|l| factor * l).collect();
            let found = exponent(&scaled, 0.5, MOST).expect("weights");
            assert!((found * factor / beta - 1.0).abs() < 1e-9, "seed {seed}, × {factor}: {found} for {beta}");
        }
    }
}

/// A5.
#[test]
fn equal_weights_are_flat_and_one_state_is_one() {
    let flat = [-7.3; 12];
    assert_eq!(exponent(&flat, 0.5, MOST), Ok(MOST));
    assert_eq!(weights(&flat, MOST), [1.0 / 12.0; 12]);
    let mut one = [f64::NEG_INFINITY; 12];
    one[4] = -7.3;
    let beta = exponent(&one, 0.5, MOST).expect("one state");
    assert_eq!(beta, MOST);
    assert_eq!(survivors(&one, beta), 1.0);
    assert!(weights(&one, beta).iter().all(|w| !w.is_nan()));
}
