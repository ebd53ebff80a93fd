//! Exact ranks of a draw within the path that passes through it (Gandy & Scott 2020, algorithm 2).
//!
//! A path of L + 1 states is begun at a place M that is uniform on 0 … L, with a draw x_M ~ π; the kernel runs it forward to L, the reversed kernel backward to 0. If the kernel keeps π, the rank of h(x_M) among the
//! h of the path is uniform on 0 … L, whatever h is and however the path is correlated. Counts of ranks are compared with that by χ². Ties, which rejections make, are broken at random.
//!
//! A reversible kernel (every Metropolis–Hastings kernel with one proposal) is its own reversal. A sweep over coordinates in a fixed order is not: its reversal sweeps the other way.

use crate::draws::index;
use crate::exact_start::{LEAST_MOVED, Moved};
use crate::p_values::uniform_counts;
use crate::sequential::{About, Control, Measured, run};
use crate::{Report, TestFunctions};
use sinew_core::random::{BlockRng, Stage};

/// Sizes of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactRank {
    /// Paths of the first stage.
    pub paths: usize,
    /// Kernel steps L of a path; there are L + 1 ranks. At least 1.
    pub steps: usize,
    /// Share of paths that must move: lower it for a kernel that moves rarely by design, and take more paths.
    pub least_moved: f64,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for ExactRank {
    fn default() -> Self {
        Self { paths: 4000, steps: 9, least_moved: LEAST_MOVED, seed: 1, control: Control::default() }
    }
}

const SHOWS: &str = "the kernel does not keep its target, or the backward kernel is not its reversal: detailed balance is broken, for instance by a sweep in fixed order that is tested as if it were reversible";

/// Tests a kernel together with its reversal; a reversible kernel is given twice.
///
/// # Panics
/// Without a path, a step and a test function.
pub fn exact_rank(
    config: &ExactRank,
    mut draw: impl FnMut(&mut BlockRng) -> Vec<f64>,
    mut forward: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    mut backward: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    functions: &TestFunctions<'_>,
) -> Report {
    let stages = Stage::new(config.seed, "exact ranks");
    assert!(config.paths > 0 && config.steps > 0, "at least one path and one step");
    functions.assert_some();
    let ranks = config.steps + 1;
    let mut moved = Moved::default();
    let measured = |paths| format!("{paths} paths of {ranks} states through a draw from the target at a random place");
    let about = About { test: "exact ranks", would_show: SHOWS, seed: config.seed, measured: &measured };
    let mut report = run(&config.control, &about, config.paths, |paths, stage| {
        let mut rng = stages.round(stage).whole();
        let mut counts = vec![vec![0; ranks]; functions.names().len()];
        for _ in 0..paths {
            let place = index(ranks, &mut rng);
            let start = draw(&mut rng);
            let at_start = functions.at(&start);
            let mut tallies = vec![Tally::default(); at_start.len()];
            let mut walk =
                |steps: usize, kernel: &mut dyn FnMut(&[f64], &mut BlockRng) -> Vec<f64>, rng: &mut BlockRng| {
                    let mut state = start.clone();
                    for _ in 0..steps {
                        state = kernel(&state, rng);
                        let values = functions.at(&state);
                        tallies
                            .iter_mut()
                            .zip(&at_start)
                            .zip(values)
                            .for_each(|((tally, &at), value)| tally.add(at, value));
                    }
                    state != start
                };
            let moved_back = walk(place, &mut backward, &mut rng);
            let moved_on = walk(ranks - 1 - place, &mut forward, &mut rng);
            moved.add(moved_back || moved_on);
            for (counts, tally) in counts.iter_mut().zip(&tallies) {
                counts[tally.rank(&mut rng)] += 1;
            }
        }
        let found = functions.names().iter().zip(&counts).map(|(name, counts)| {
            let (value, p) = uniform_counts(counts);
            Measured { name: format!("χ² of the ranks of {name}"), value, p, one_sigma: None }
        });
        found.collect()
    });
    report.statistics.push(moved.statistic(config.least_moved));
    report
}

/// How many values lie below, and how many at, the one to be ranked.
#[derive(Clone, Copy, Default)]
pub(crate) struct Tally {
    below: usize,
    equal: usize,
}

impl Tally {
    pub(crate) fn add(&mut self, at: f64, value: f64) {
        self.below += usize::from(value < at);
        self.equal += usize::from(value == at);
    }

    /// The rank, ties broken at random.
    pub(crate) fn rank(&self, rng: &mut BlockRng) -> usize {
        self.below + if self.equal > 0 { index(self.equal + 1, rng) } else { 0 }
    }
}
