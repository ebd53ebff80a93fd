//! Simulation-based calibration (Talts et al. 2018): the rank of the true parameter within draws from its posterior is uniform.
//!
//! For each data set θ* ~ p(θ), y ~ p(y | θ*), and n draws from the posterior under test; then the rank of h(θ*, y) among the h(θ_i, y) is uniform on 0 … n if the draws are independent draws from the posterior. Two
//! statistics for every test function: χ² of the ranks in bins, and the largest distance of their distribution function from the diagonal, with the bound of Dvoretzky, Kiefer & Wolfowitz (2 exp(−2 N D²), rigorous).
//!
//! Shapes of the histogram have names: ∪ intervals too narrow, ∩ too wide, a slope a bias, a spike at an end draws that are correlated or stuck.

use crate::detectable::Wrong;
use crate::exact_rank::Tally;
use crate::p_values::against_expected;
use crate::sequential::{About, Control, Measured, run};
use crate::{Report, TestFunctions};
use sinew_core::random::{BlockRng, Stage};

/// Sizes of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankCalibration {
    /// Data sets of the first stage.
    pub data_sets: usize,
    /// Posterior draws n for each; thin chains until neighbours hardly know of each other.
    pub draws: usize,
    /// Bins of the histogram; fewer where there are fewer than five data sets a bin.
    pub bins: usize,
    /// Seed.
    pub seed: u64,
    /// How much evidence a verdict needs.
    pub control: Control,
}

impl Default for RankCalibration {
    fn default() -> Self {
        Self { data_sets: 500, draws: 99, bins: 20, seed: 1, control: Control::default() }
    }
}

/// Ranks of the true values, for plots.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranks {
    /// Name of each test function.
    pub names: Vec<String>,
    /// For each, one rank a data set.
    pub ranks: Vec<Vec<usize>>,
    /// Draws n of a data set: the largest rank.
    pub draws: usize,
}

const SHOWS: &str = "intervals from these draws do not cover what they say: the posterior of the sampler is too narrow (ranks at both ends), too wide (ranks in the middle), shifted, or its draws are not independent";

/// Tests `posterior(y, n, rng)`, which returns n draws, against `prior(rng)` and `simulate(θ, rng)`. Test functions see θ followed by y.
///
/// # Panics
/// When `posterior` returns another number of draws than were requested, and without a data set, a draw and a test function.
pub fn calibration(
    config: &RankCalibration,
    mut prior: impl FnMut(&mut BlockRng) -> Vec<f64>,
    mut simulate: impl FnMut(&[f64], &mut BlockRng) -> Vec<f64>,
    mut posterior: impl FnMut(&[f64], usize, &mut BlockRng) -> Vec<Vec<f64>>,
    functions: &TestFunctions<'_>,
) -> (Report, Ranks) {
    let stages = Stage::new(config.seed, "calibration");
    let draws = config.draws;
    assert!(config.data_sets > 0 && draws > 0, "at least one data set and one draw");
    functions.assert_some();
    // Five data sets a bin at least: fewer are too few for χ².
    let bins = config.bins.min(draws + 1).min(config.data_sets / 5).max(2);
    let every_rank: Vec<usize> = (0..=draws).collect();
    let mut ranks = Ranks { names: functions.names().to_vec(), ranks: vec![], draws };
    let measured =
        |sets| format!("ranks of the truth among {draws} posterior draws for each of {sets} data sets, in {bins} bins");
    let about = About { test: "calibration", would_show: SHOWS, seed: config.seed, measured: &measured };
    let report = run(&config.control, &about, config.data_sets, |sets, stage| {
        let mut rng = stages.round(stage).whole();
        ranks.ranks = vec![Vec::with_capacity(sets); functions.names().len()];
        for _ in 0..sets {
            let truth = prior(&mut rng);
            let data = simulate(&truth, &mut rng);
            let sample = posterior(&data, draws, &mut rng);
            assert_eq!(sample.len(), draws, "posterior draws");
            let at = functions.at(&[&*truth, &*data].concat());
            let mut tallies = vec![Tally::default(); at.len()];
            for draw in sample {
                let values = functions.at(&[&*draw, &*data].concat());
                tallies.iter_mut().zip(&at).zip(values).for_each(|((tally, &at), value)| tally.add(at, value));
            }
            ranks.ranks.iter_mut().zip(&tallies).for_each(|(ranks, tally)| ranks.push(tally.rank(&mut rng)));
        }
        let found = ranks.names.iter().zip(&ranks.ranks).flat_map(|(name, ranks)| {
            let (value, p) = against_expected(&histogram(ranks, draws, bins), &histogram(&every_rank, draws, bins));
            let distance = distance_from_uniform(ranks, draws);
            [
                Measured { name: format!("χ² of the ranks of {name}"), value, p, one_sigma: None },
                Measured {
                    name: format!("distance of the ranks of {name} from uniform"),
                    value: distance,
                    p: (2.0 * (-2.0 * sets as f64 * distance * distance).exp()).min(1.0),
                    one_sigma: Some((format!("ranks of {name}"), (Wrong::Distribution, (sets as f64).sqrt().recip()))),
                },
            ]
        });
        found.collect()
    });
    (report, ranks)
}

/// Counts of ranks 0 … `draws` in bins bin ⌊rank · bins / (draws + 1)⌋. Uniform ranks fill them equally where `bins` divides `draws` + 1.
#[must_use]
pub fn histogram(ranks: &[usize], draws: usize, bins: usize) -> Vec<u64> {
    let mut counts = vec![0; bins];
    for rank in ranks {
        counts[rank * bins / (draws + 1)] += 1;
    }
    counts
}

/// Distribution function of ranks minus that of uniform ranks, at 0 … `draws`.
#[must_use]
pub fn ecdf_difference(ranks: &[usize], draws: usize) -> Vec<f64> {
    let counts = histogram(ranks, draws, draws + 1);
    let mut below = 0;
    counts
        .iter()
        .enumerate()
        .map(|(rank, count)| {
            below += count;
            below as f64 / ranks.len() as f64 - (rank + 1) as f64 / (draws + 1) as f64
        })
        .collect()
}

fn distance_from_uniform(ranks: &[usize], draws: usize) -> f64 {
    ecdf_difference(ranks, draws).into_iter().fold(0.0, |largest, d| d.abs().max(largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_ranks_fill_bins_equally_and_lie_on_the_diagonal() {
        let ranks: Vec<usize> = (0..100).collect();
        assert_eq!(histogram(&ranks, 99, 20), [5; 20]);
        assert!(distance_from_uniform(&ranks, 99) < 1e-12);
        assert_eq!(histogram(&[0, 0, 99], 99, 4), [2, 0, 0, 1]);
        assert!((distance_from_uniform(&[0; 10], 99) - 0.99).abs() < 1e-12);
    }
}
