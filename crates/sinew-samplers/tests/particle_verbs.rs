//! The verbs of a particle filter against the exact filter of a scalar random walk.
//! They are put together with every resampling scheme and rule.
//!
//! For each run Ẑ Σ W_i f(x_i) is an unbiased estimate of Z E[f(x_T) | z], for any number of particles (Del Moral 2004, theorem 7.4.2): f = 1 is the evidence, f = x and x² see weights that belong to others. Means over
//! independent runs by |z| < 4.5, a false alarm in 1.5e5 each.

use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::particles::{Particles, predict, predict_and_reweight, resample, reweight, start};
use sinew_samplers::resample::Scheme;
use std::f64::consts::TAU;

const STEP: f64 = 0.8;
const NOISE: f64 = 0.6;
const SEEN: [f64; 5] = [0.4, 1.9, 1.1, -0.3, 0.2];

/// x' = x + N(0, 0.8²), from 0.
struct Walk;

impl MotionModel for Walk {
    fn dim(&self) -> usize {
        1
    }
}

impl Transition for Walk {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::baseline(), next);
        (0..LANES).for_each(|lane| next[0].0[lane] = previous[0].0[lane] + STEP * next[0].0[lane]);
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        -0.5 * ((next[0] - previous[0]) / STEP).powi(2) - 0.5 * (TAU * STEP * STEP).ln()
    }
}

/// z = x + N(0, 0.6²).
struct Sight(f64);

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        -0.5 * ((self.0 - x[0]) / NOISE).powi(2) - 0.5 * (TAU * NOISE * NOISE).ln()
    }
}

/// Evidence, and mean and variance of the last state.
fn exact() -> (f64, f64, f64) {
    let (mut log_z, mut mean, mut variance) = (0.0, 0.0, 0.0);
    for z in SEEN {
        variance += STEP * STEP;
        let predicted = variance + NOISE * NOISE;
        log_z += -0.5 * (z - mean).powi(2) / predicted - 0.5 * (TAU * predicted).ln();
        let gain = variance / predicted;
        mean += gain * (z - mean);
        variance *= 1.0 - gain;
    }
    (log_z, mean, variance)
}

/// log Ẑ and the particles of one run; resampled where N_eff / N ≤ `below`.
fn run(count: usize, scheme: Scheme, below: f64, seed: u64) -> (f64, Particles) {
    let mut particles = Particles::new(&[0.0], count).expect("not empty");
    let mut log_z = 0.0;
    for (frame, z) in SEEN.into_iter().enumerate() {
        let [to_resample, to_move] = Stage::new(seed, "verbs").at_frame(frame as u32).split(["resample", "move"]);
        log_z += if frame == 0 {
            start(&mut particles, &Walk, &[0.0], to_move);
            reweight(&mut particles, &Sight(z))
        } else {
            let wanted = particles.effective_sample_size() <= below * count as f64;
            let ancestors = wanted.then(|| resample(&particles, scheme, to_resample));
            predict_and_reweight(&mut particles, ancestors, &Walk, &Sight(z), to_move)
        }
        .expect("weights");
    }
    (log_z, particles)
}

/// 4 schemes, 3 rules, 3 functions: 36 statistics, false alarm 2.4e-4. Seeds 0 to 299.
#[test]
fn evidence_and_moments_are_unbiased_under_every_scheme_and_rule() {
    let (log_z, mean, variance) = exact();
    for scheme in [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic] {
        for below in [0.0, 0.5, 1.0] {
            let estimates: Vec<[f64; 3]> = (0..300)
                .map(|seed| {
                    let (log_estimate, particles) = run(100, scheme, below, seed);
                    let ratio = (log_estimate - log_z).exp();
                    let x = (0..100).map(|i| particles.states()[i / LANES].0[i % LANES]);
                    let weighted = x.zip(particles.weights());
                    let (first, second) = weighted.fold((0.0, 0.0), |(a, b), (x, w)| (a + w * x, b + w * x * x));
                    [ratio, ratio * first, ratio * second]
                })
                .collect();
            for (k, exact) in [1.0, mean, variance + mean * mean].into_iter().enumerate() {
                let n = estimates.len() as f64;
                let found = estimates.iter().map(|e| e[k]).sum::<f64>() / n;
                let spread = estimates.iter().map(|e| (e[k] - found).powi(2)).sum::<f64>() / (n - 1.0);
                let z = (found - exact) / (spread / n).sqrt();
                let what = ["evidence", "mean", "square"][k];
                assert!(
                    z.abs() < 4.5,
                    "{scheme:?}, below {below}, {what}: {found} against {exact}, z = {z}, bound 4.5"
                );
            }
        }
    }
}

/// Mean counts of resampling schemes (R1) in reduced size: 4 × 7 statistics at |z| < 4.5, false alarm 2e-4; seed 4. Expected counts are whole, fractions and 0.
#[test]
fn counts_have_the_expected_mean_under_every_scheme() {
    let weights = [0.0, 2.0, 0.3, 1.7, 0.05, 0.45, 1.5];
    let (n, replicates) = (6, 20_000);
    let mut rng = Stage::new(4, "counts").whole();
    for scheme in [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic] {
        let mut sums = [[0.0; 2]; 7];
        for _ in 0..replicates {
            let mut counts = [0.0; 7];
            scheme.ancestors(&weights, n, &mut rng).iter().for_each(|&a| counts[a] += 1.0);
            for (sums, (count, weight)) in sums.iter_mut().zip(counts.iter().zip(weights)) {
                let error: f64 = count - weight;
                sums[0] += error / f64::from(replicates);
                sums[1] += error * error / f64::from(replicates);
            }
        }
        for (i, [mean, square]) in sums.into_iter().enumerate() {
            // A count that cannot vary must be right.
            let z = mean / ((square - mean * mean).max(1e-20) / f64::from(replicates)).sqrt();
            assert!(z.abs() < 4.5 || mean.abs() < 1e-12, "{scheme:?}, state {i}: off by {mean}, z = {z}, bound 4.5");
        }
    }
}

/// Moving and weighing in one pass is moving and then weighing, with ancestors and without.
#[test]
fn one_pass_does_what_two_do() {
    let (_, before) = run(53, Scheme::Stratified, 0.5, 1);
    for resampled in [false, true] {
        let ancestors = || resampled.then(|| resample(&before, Scheme::Systematic, Stage::new(2, "ancestors")));
        let (mut once, mut twice) = (before.clone(), before.clone());
        let evidence = predict_and_reweight(&mut once, ancestors(), &Walk, &Sight(0.3), Stage::new(3, "move"));
        predict(&mut twice, ancestors(), &Walk, Stage::new(3, "move"));
        assert_eq!(evidence, reweight(&mut twice, &Sight(0.3)));
        assert_eq!((once.states(), once.weights()), (twice.states(), twice.weights()));
        assert_eq!(once.log_weights(), twice.log_weights());
        assert_eq!(once.log_weights().len(), 53);
        assert!(once.log_weights().iter().zip(once.weights()).all(|(log, w)| (log.exp() - w).abs() < 1e-14));
        let weighed: Vec<f64> = (0..53)
            .map(|i| {
                let earlier = if resampled { 1.0 } else { before.weights()[i] };
                earlier * Sight(0.3).log_density(&[once.states()[i / LANES].0[i % LANES]]).exp()
            })
            .collect();
        let sum: f64 = weighed.iter().sum();
        for (w, weight) in weighed.iter().zip(once.weights()) {
            assert!((w / sum - weight).abs() < 1e-12, "{w} / {sum} against {weight}");
        }
    }
}
