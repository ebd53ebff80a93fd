//! Tests of resampling schemes.
//!
//! Every index is taken N W_i times on average, never when its weight is zero, and as often as its scheme allows.
//!
//! For given weights and a number N of offspring, over many replicates:
//!
//! - indices are in range and N in number, weights of zero are never taken, counts keep the bounds of the scheme: exactly, in every replicate;
//! - the mean count of each index is N W_i: p-values are Chernoff's bound, 2 exp(−T KL(q̂ ‖ q)), which holds for any number of offspring, rare or not (Hoeffding 1963). Here q is the expected share of T trials: for a
//!   multinomial each offspring is a trial; where the scheme is sure of ⌊N W_i⌋ copies only what it may add to them is.

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

/// Tests `scheme(weights, N, rng)`, which returns the index of each offspring's parent.
///
/// # Panics
/// Unless `weights` are normalised and there are replicates and offspring.
pub fn resampling(
    config: &Resampling,
    weights: &[f64],
    mut scheme: impl FnMut(&[f64], usize, &mut BlockRng) -> Vec<usize>,
) -> Report {
    assert!(config.replicates > 0 && config.offspring > 0, "at least one replicate and one offspring");
    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-9, "weights that sum to 1");
    let stages = Stage::new(config.seed, "resampling");
    let n = config.offspring;
    let measured = |replicates| format!("{replicates} replicates of {n} offspring from {} weights", weights.len());
    let about = About { test: "resampling", would_show: SHOWS, seed: config.seed, measured: &measured };
    let trials = config.law.trials(weights, n);
    let mut broken = Broken::default();
    let mut report = run(&config.control, &about, config.replicates, |replicates, stage| {
        let mut rng = stages.round(stage).whole();
        let mut sums = vec![0.0; weights.len()];
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
            for ((sum, count), &w) in sums.iter_mut().zip(counts).zip(weights) {
                broken.zero_taken += if w == 0.0 { count } else { 0.0 };
                broken.outside_law = broken.outside_law.max(config.law.excess(count, n as f64 * w));
                *sum += count;
            }
        }
        let r = replicates as f64;
        let found = sums.iter().zip(weights).zip(&trials).enumerate().map(|(i, ((sum, w), trials))| Measured {
            name: format!("mean count of index {i}, weight {w:.3e}, less what is expected"),
            value: sum / r - n as f64 * w,
            p: trials.p_value(sum / r, r),
            one_sigma: None,
        });
        found.collect()
    });
    report.statistics.extend(broken.statistics());
    report
}

/// What of a count is left to chance in one replicate.
struct Trials {
    /// Copies that are sure.
    sure: f64,
    /// Most that may be added.
    most: f64,
    /// What is added on average.
    expected: f64,
    /// Independent or negatively associated indicators that make it up; 1 for a number between 0 and `most` of any law.
    indicators: f64,
}

impl Trials {
    /// Of a mean count over `replicates`.
    fn p_value(&self, mean: f64, replicates: f64) -> f64 {
        if self.most <= 0.0 {
            return if (mean - self.sure).abs() * replicates < 0.5 { 1.0 } else { 0.0 };
        }
        let share = |x: f64| (x / self.most).clamp(0.0, 1.0);
        let (found, expected) = (share(mean - self.sure), share(self.expected));
        let part = |a: f64, b: f64| if a > 0.0 { a * (a / b).ln() } else { 0.0 };
        let divergence = part(found, expected) + part(1.0 - found, 1.0 - expected);
        (2.0 * (-replicates * self.indicators * divergence.max(0.0)).exp()).min(1.0)
    }
}

impl CountLaw {
    fn trials(self, weights: &[f64], n: usize) -> Vec<Trials> {
        let whole = |w: f64| (n as f64 * w + 1e-9).floor();
        let drawn = n as f64 - weights.iter().map(|&w| whole(w)).sum::<f64>();
        let of = |&w: &f64| {
            let mean = n as f64 * w;
            let (sure, most, indicators) = match self {
                Self::Free => (0.0, n as f64, n as f64),
                Self::AtLeastFloor => (whole(w), drawn, drawn),
                Self::FloorOrCeiling => (whole(w), 1.0, 1.0),
                Self::WithinTwo => {
                    let sure = (mean - 2.0).ceil().max(0.0);
                    (sure, (mean + 2.0).floor().min(n as f64) - sure, 1.0)
                }
            };
            Trials { sure, most, expected: (mean - sure).max(0.0), indicators }
        };
        weights.iter().map(of).collect()
    }
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
