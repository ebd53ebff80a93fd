//! Exact starts: a draw from the target that the kernel moves is again one.
//!
//! For each start x ~ π and its image x′ after k steps, the test compares h(x′) with h(x) pair by pair, which cancels most of the noise:
//!
//! - the mean of h(x′) − h(x) over its standard error, for every test function h;
//! - the numbers of starts that rise and fall across the median of h, which are equally likely, with the exact law of signs: no moments needed.
//!
//! A report says what size of error would have been seen: of a standard deviation, or a mean, of the target that the kernel keeps instead of π (for a reversible kernel and a small error; see [`crate::Report::detectable`]).
//!
//! No burn-in, no autocorrelation, no tuning of the comparison. A kernel that does not move keeps any target; one that moves fewer starts than `least_moved`, by default one in a hundred, fails
//! here, since next to nothing was tested. What this test cannot see: a kernel that moves within a part of the state only. [`crate::long_run`] sees that.

use crate::detectable::{Estimate, one_sigma};
use crate::p_values::{mean_is_zero, signs_p};
use crate::report::{Bound, Statistic};
use crate::sequential::{About, Control, Measured, run};
use crate::{Report, TestFunctions};
use sinew_core::random::{BlockRng, Stage};

/// Sizes of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactStart {
    /// Starts of the first stage.
    pub starts: usize,
    /// Kernel steps from each start.
    pub steps: usize,
    /// Share of starts that must end elsewhere: lower it for a kernel that moves rarely by design, and take more starts.
    pub least_moved: f64,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for ExactStart {
    fn default() -> Self {
        Self { starts: 100_000, steps: 1, least_moved: LEAST_MOVED, seed: 1, control: Control::default() }
    }
}

/// Draws beforehand from which medians are taken.
const PILOT: usize = 201;

const SHOWS: &str = "the kernel does not keep its target: a wrong acceptance ratio, a proposal ratio forgotten, a trajectory that loses volume, a rejected state not counted, noise of a wrong size. \
     A wrong gradient passes: it costs acceptance only";

/// Tests `transition` against exact draws of its target.
///
/// # Panics
/// Without two starts, a step and a test function.
pub fn exact_start(
    config: &ExactStart,
    mut draw: impl FnMut(&mut BlockRng) -> Vec<f64>,
    mut transition: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
) -> Report {
    let [pilot, stages] = Stage::new(config.seed, "exact start").split(["pilot", "stages"]);
    let medians = medians(&mut draw, functions, &mut pilot.whole());
    let steps = config.steps;
    assert!(config.starts > 1 && steps > 0, "at least two starts and one step");
    functions.assert_some();
    let measured =
        |starts| format!("{starts} starts drawn from the target, each moved by {steps} step(s), compared pair by pair");
    let about = About { test: "exact start", would_show: SHOWS, seed: config.seed, measured: &measured };
    let mut moved = Moved::default();
    let mut report = run(&config.control, &about, config.starts, |starts, stage| {
        let mut rng = stages.round(stage).whole();
        let mut sums = vec![Sums::default(); medians.len()];
        for _ in 0..starts {
            let first = draw(&mut rng);
            let mut last = transition(&first, &mut rng);
            for _ in 1..steps {
                last = transition(&last, &mut rng);
            }
            moved.add(first != last);
            let (before, after) = (functions.at(&first), functions.at(&last));
            for (j, sums) in sums.iter_mut().enumerate() {
                sums.add(before[j], after[j], medians[j]);
            }
        }
        let sizes = one_sigma(functions, &sums.iter().map(|sums| sums.estimate(starts as f64)).collect::<Vec<_>>());
        let found = functions.names().iter().zip(&sums).zip(sizes).flat_map(|((name, sums), size)| {
            let (z, p) = mean_is_zero(sums.difference, sums.square, starts);
            let balance = (sums.up as f64 - sums.down as f64) / ((sums.up + sums.down).max(1) as f64).sqrt();
            [
                Measured {
                    name: format!("mean of {name}"),
                    value: z,
                    p,
                    one_sigma: size.map(|size| (name.clone(), size)),
                },
                Measured {
                    name: format!("crossings of the median of {name}"),
                    value: balance,
                    p: signs_p(sums.up, sums.down),
                    one_sigma: None,
                },
            ]
        });
        found.collect()
    });
    report.statistics.push(moved.statistic(config.least_moved));
    report
}

/// How many starts ended elsewhere.
#[derive(Default)]
pub(crate) struct Moved {
    starts: u64,
    moved: u64,
}

/// Of a kernel that moves fewer than one start in a hundred these tests see next to nothing.
pub(crate) const LEAST_MOVED: f64 = 0.01;

impl Moved {
    pub(crate) fn add(&mut self, moved: bool) {
        self.starts += 1;
        self.moved += u64::from(moved);
    }

    pub(crate) fn statistic(&self, least: f64) -> Statistic {
        Statistic {
            name: "share of starts that moved".into(),
            value: self.moved as f64 / self.starts.max(1) as f64,
            bound: Bound::Range { least, most: f64::INFINITY },
        }
    }
}

/// Medians of the test functions over a few draws.
fn medians(
    draw: &mut impl FnMut(&mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
    rng: &mut BlockRng,
) -> Vec<f64> {
    let values: Vec<Vec<f64>> = (0..PILOT).map(|_| functions.at(&draw(rng))).collect();
    let median = |j: usize| sinew_core::estimators::median(&mut values.iter().map(|v| v[j]).collect::<Vec<_>>());
    (0..functions.names().len()).map(median).collect()
}

#[derive(Clone, Default)]
struct Sums {
    before: f64,
    before_square: f64,
    difference: f64,
    square: f64,
    up: u64,
    down: u64,
}

impl Sums {
    fn add(&mut self, before: f64, after: f64, median: f64) {
        let change = after - before;
        self.before += before;
        self.before_square += before * before;
        self.difference += change;
        self.square += change * change;
        match (before > median, after > median) {
            (false, true) => self.up += 1,
            (true, false) => self.down += 1,
            _ => {}
        }
    }

    /// Of the mean of h under the target that the kernel keeps instead, if it keeps one.
    ///
    /// With the target π (1 + ε (h − E h)) instead of π a reversible kernel moves the mean of h over π by ε (1 − ρ) Var h, and its own target has it off by ε Var h, ρ the correlation of h(x) with h(x′). Over starts
    /// E (h(x′) − h(x))² = 2 (1 − ρ) Var h.
    fn estimate(&self, starts: f64) -> Estimate {
        let mean = self.before / starts;
        let variance = self.before_square / starts - mean * mean;
        Estimate { mean, variance, error: 2.0 * variance / self.square.sqrt() }
    }
}
