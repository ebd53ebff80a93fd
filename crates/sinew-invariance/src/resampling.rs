//! Resampling: every index is taken N W_i times on average, never when its weight is zero, and as often as its scheme allows.
//!
//! For given weights and a number N of offspring, over many replicates:
//!
//! - indices are in range and N in number, weights of zero are never taken, counts keep the bounds of the scheme: exactly, in every replicate;
//! - the mean count of each index is N W_i (z-scores). Indices with fewer than 25 expected offspring over all replicates are pooled and judged by Chernoff's bound on too many, since the normal law would not hold for them.

use crate::p_values::of_z;
use crate::report::{Bound, Report, Statistic};
use crate::sequential::{About, Control, Measured, run};
use sinew_core::random::{BlockRng, Stage};

/// Bounds that a scheme gives for each count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountLaw {
    /// None: multinomial.
    Free,
    /// At least ⌊N W_i⌋: residual.
    AtLeastFloor,
    /// ⌊N W_i⌋ or ⌈N W_i⌉: systematic.
    FloorOrCeiling,
    /// Within 2 of N W_i: stratified.
    WithinTwo,
}

impl CountLaw {
    /// How far a count lies outside. Rounding of N W_i may move it across an integer: both sides of one that is 1e-9 near are allowed.
    fn excess(self, count: f64, expected: f64) -> f64 {
        let (low, high) = ((expected - 1e-9).floor(), (expected + 1e-9).ceil());
        match self {
            Self::Free => 0.0,
            Self::AtLeastFloor => (low - count).max(0.0),
            Self::FloorOrCeiling => (low - count).max(count - high).max(0.0),
            Self::WithinTwo => ((count - expected).abs() - 2.0).max(0.0),
        }
    }
}

/// Sizes of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resampling {
    /// Replicates of the first stage.
    pub replicates: usize,
    /// Number N of offspring.
    pub offspring: usize,
    /// What the scheme promises.
    pub law: CountLaw,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for Resampling {
    fn default() -> Self {
        Self { replicates: 5000, offspring: 47, law: CountLaw::Free, seed: 1, control: Control::default() }
    }
}

const SHOWS: &str = "resampling is biased: a cumulative sum that ends below 1, W used for N W, an index off by one, weights that are not the ones of the particles";

/// Tests `scheme(weights, N, rng)`, which returns the index of each offspring's parent. `weights` sum to 1.
pub fn resampling(
    config: &Resampling,
    weights: &[f64],
    mut scheme: impl FnMut(&[f64], usize, &mut BlockRng) -> Vec<usize>,
) -> Report {
    let stages = Stage::new(config.seed, "resampling");
    let n = config.offspring;
    let measured = |replicates| format!("{replicates} replicates of {n} offspring from {} weights", weights.len());
    let about = About { test: "resampling", would_show: SHOWS, seed: config.seed, measured: &measured };
    let mut broken = Broken::default();
    let mut report = run(&config.control, &about, config.replicates, |replicates, stage| {
        let mut rng = stages.round(stage).whole();
        let rare = |w: f64| w * (n * replicates) as f64 <= 25.0;
        let mut sums = vec![(0.0, 0.0); weights.len()];
        let mut rare_taken = 0.0;
        for _ in 0..replicates {
            let mut counts = vec![0.0; weights.len()];
            let parents = scheme(weights, n, &mut rng);
            broken.wrong_number += f64::from(u8::from(parents.len() != n));
            for parent in parents {
                match counts.get_mut(parent) {
                    Some(count) => *count += 1.0,
                    None => broken.out_of_range += 1.0,
                }
            }
            for (i, (&count, &w)) in counts.iter().zip(weights).enumerate() {
                broken.zero_taken += if w == 0.0 { count } else { 0.0 };
                broken.outside_law = broken.outside_law.max(config.law.excess(count, n as f64 * w));
                let off = count - n as f64 * w;
                if rare(w) {
                    rare_taken += count;
                } else {
                    sums[i].0 += off;
                    sums[i].1 += off * off;
                }
            }
        }
        let r = replicates as f64;
        let mut found: Vec<Measured> = vec![];
        for (i, (&w, &(sum, square))) in weights.iter().zip(&sums).enumerate().filter(|(_, (w, _))| !rare(**w)) {
            // Counts that never vary are judged by one offspring in all replicates.
            let error = ((square / r - (sum / r).powi(2)).max(0.0) / r).sqrt().max(1.0 / r);
            let z = sum / r / error;
            found.push(Measured { name: format!("mean count of index {i}, weight {w:.3e}"), value: z, p: of_z(z) });
        }
        let expected = weights.iter().filter(|&&w| rare(w)).sum::<f64>() * n as f64 * r;
        let taken = rare_taken.round();
        let name = format!("offspring of all rare indices together, {expected:.3} expected");
        found.push(Measured { name, value: taken, p: of_many(taken, expected) });
        found
    });
    report.statistics.extend(broken.statistics());
    report
}

/// Chernoff's bound on the probability of `taken` or more where `expected` are expected, for sums of indicators that are independent or negatively associated.
fn of_many(taken: f64, expected: f64) -> f64 {
    if taken <= expected {
        return 1.0;
    }
    (taken - expected + taken * (expected / taken).ln()).exp()
}

/// What no replicate may do.
#[derive(Default)]
struct Broken {
    wrong_number: f64,
    out_of_range: f64,
    zero_taken: f64,
    outside_law: f64,
}

impl Broken {
    fn statistics(&self) -> [Statistic; 4] {
        let none =
            |name: &str, value| Statistic { name: name.into(), value, bound: Bound::Range { least: 0.0, most: 0.0 } };
        [
            none("replicates with a wrong number of offspring", self.wrong_number),
            none("offspring of an index out of range", self.out_of_range),
            none("offspring of weight zero", self.zero_taken),
            none("largest excess over the bounds of the scheme", self.outside_law),
        ]
    }
}
