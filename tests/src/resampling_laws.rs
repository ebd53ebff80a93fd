//! Resampling schemes against their laws (mean counts R1, bounds of counts R2, edge cases R4, `resample-unbiased`).
//!
//! For weights with zeros, denormals and one that is nearly all.

use crate::size::Size;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use sinew::core::random::BlockRng;
use sinew::samplers::resample::Scheme;
use sinew_invariance::{CountLaw, Report, Resampling, resampling, strategies};

/// Schemes with what they promise.
pub const SCHEMES: [(Scheme, CountLaw); 4] = [
    (Scheme::Multinomial, CountLaw::Free),
    (Scheme::Residual, CountLaw::AtLeastFloor),
    (Scheme::Stratified, CountLaw::WithinTwo),
    (Scheme::Systematic, CountLaw::FloorOrCeiling),
];

/// Weights from the strategies of the kit; the same for the same seed.
///
/// # Panics
/// Never: the strategy refuses nothing.
#[must_use]
pub fn weight_vectors(seed: u64, count: usize) -> Vec<Vec<f64>> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let mut runner = TestRunner::new_with_rng(Config::default(), TestRng::from_seed(RngAlgorithm::ChaCha, &bytes));
    let strategy = strategies::weights(1..=40);
    (0..count).map(|_| strategy.new_tree(&mut runner).expect("weights").current()).collect()
}

/// Weights that have broken other resamplers, normalised.
fn hard_weights() -> Vec<Vec<f64>> {
    let mut nearly_one = vec![1e-16 / 7.0; 8];
    nearly_one[3] = 1.0 - 1e-16;
    let falling: Vec<f64> = (0..40).map(|i| 0.5_f64.powi(i)).collect();
    let mut zeros = vec![0.0; 30];
    (0..30).step_by(3).for_each(|i| zeros[i] = 1.0 + i as f64);
    let mut all = vec![
        zeros,
        nearly_one,
        vec![5e-324, 0.25, 1e-310, 0.0, 0.75, -0.0, 5e-324],
        falling,
        vec![1e300, 3e300, 0.0, 2e300],
        vec![0.4],
    ];
    for weights in &mut all {
        let largest = weights.iter().copied().fold(0.0, f64::max);
        let sum: f64 = weights.iter().map(|w| w / largest).sum();
        weights.iter_mut().for_each(|w| *w = *w / largest / sum);
    }
    all
}

/// Each scheme on weights of all kinds and on equal weights, with fewer, as many and more offspring than weights.
#[must_use]
pub fn every_scheme(seed: u64, size: Size) -> Vec<Report> {
    let mut reports = vec![];
    let mut all = weight_vectors(seed, size.pick(6, 60));
    all.extend([vec![1.0], vec![0.25; 4], vec![0.0, 1.0, 0.0]]);
    all.extend(hard_weights());
    for (scheme, law) in SCHEMES {
        for (i, weights) in all.iter().enumerate() {
            let offspring = [1, weights.len(), 2 * weights.len() + 3][i % 3];
            let config = Resampling {
                replicates: size.pick(2000, 100_000),
                offspring,
                law,
                seed: seed.wrapping_add(i as u64),
                ..Resampling::default()
            };
            let draw = |w: &[f64], n: usize, rng: &mut BlockRng| scheme.ancestors(w, n, rng);
            let report = resampling(&config, weights, draw);
            reports.push(Report { measured: format!("{scheme:?}; {}", report.measured), ..report });
        }
    }
    reports
}
