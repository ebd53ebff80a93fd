//! What the series of a scene come to: coverages with their standard errors, histograms of ranks, warnings.

use super::scene::Series;
use crate::support::statistics::mean;
use sinew_tests::evaluation;
use sinew_tests::evaluation::ranks::{self, AllUniform};
use std::collections::BTreeMap;

/// Bins of a histogram; they divide the 200 ranks.
pub(super) const BINS: usize = 20;
/// Replicates of a bootstrap.
const REPLICATES: usize = 500;

/// A scene's results.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) series: usize,
    all: Vec<Series>,
}

/// Mean over the series and its standard error: whole series are resampled.
fn with_error(values: Vec<f64>) -> [f64; 2] {
    [mean(&values), evaluation::block_bootstrap(&[values], 1, REPLICATES, 1)]
}

impl Found {
    pub(super) fn of(all: &[Series]) -> Self {
        Self { series: all.len(), all: all.to_vec() }
    }

    /// Coverage of all joints at each of the levels.
    pub(super) fn pooled(&self) -> Vec<[f64; 2]> {
        ranks::LEVELS.iter().map(|&level| self.pooled_at(level)).collect()
    }

    /// The same at one of the levels.
    pub(super) fn pooled_at(&self, level: f64) -> [f64; 2] {
        let index = ranks::LEVELS.iter().position(|known| *known == level);
        let own = |series: &Series| index.and_then(|i| series.covered.get(i)).map_or(f64::NAN, mean);
        with_error(self.all.iter().map(own).collect())
    }

    /// Coverage of a joint at the index of a level.
    pub(super) fn joint(&self, level: usize, joint: usize) -> [f64; 2] {
        with_error(self.all.iter().map(|series| series.covered[level][joint]).collect())
    }

    pub(super) fn calibration_error(&self) -> f64 {
        let found: Vec<f64> = self.pooled().iter().map(|[share, _]| *share).collect();
        ranks::calibration_error(&found, &ranks::LEVELS)
    }

    pub(super) fn in_files(&self) -> [f64; 2] {
        with_error(self.all.iter().map(|series| series.in_files).collect())
    }

    pub(super) fn half_width_mm(&self) -> f64 {
        1e3 * mean(self.all.iter().map(|series| series.half_width_m).collect::<Vec<_>>())
    }

    pub(super) fn error_mm(&self) -> f64 {
        1e3 * mean(self.all.iter().map(|series| series.error_m).collect::<Vec<_>>())
    }

    pub(super) fn disagreeing(&self) -> f64 {
        mean(self.all.iter().map(|series| series.disagreeing).collect::<Vec<_>>())
    }

    /// Relative frequency of each bin of the joints' ranks, 1 where uniform, with its standard error over the series.
    pub(super) fn histogram(&self) -> Vec<[f64; 2]> {
        let own: Vec<Vec<u64>> =
            self.all.iter().map(|series| ranks::histogram(&series.ranks, ranks::DRAWS, BINS)).collect();
        let share = |histogram: &Vec<u64>, bin: usize| {
            histogram[bin] as f64 * BINS as f64 / histogram.iter().sum::<u64>() as f64
        };
        (0..BINS).map(|bin| with_error(own.iter().map(|histogram| share(histogram, bin)).collect())).collect()
    }

    pub(super) fn shape(&self) -> ranks::Shape {
        let all: Vec<u32> = self.all.iter().flat_map(|series| series.ranks.clone()).collect();
        ranks::shape(&all, ranks::DRAWS)
    }

    /// Shape of the ranks of each coordinate, and the probability of a larger χ² where they are uniform.
    fn coordinates(&self, of: impl Fn(&Series) -> &[u32]) -> Vec<(ranks::Shape, f64)> {
        let coordinates = self.all.iter().map(|series| of(series).len()).min().unwrap_or(0);
        let law = |k: usize| {
            let own: Vec<u32> = self.all.iter().map(|series| of(series)[k]).collect();
            (ranks::shape(&own, ranks::DRAWS), ranks::uniformity(&own, ranks::DRAWS, BINS))
        };
        (0..coordinates).map(law).collect()
    }

    /// Of each degree of freedom, where its ranks are known.
    pub(super) fn state(&self) -> Vec<(ranks::Shape, f64)> {
        self.coordinates(|series| &series.state_ranks)
    }

    fn uniform(&self, of: impl Fn(&Series) -> &[u32]) -> Option<AllUniform> {
        ranks::all_uniform(&self.coordinates(of).into_iter().map(|(_, p)| p).collect::<Vec<_>>())
    }

    /// Whether the ranks of each coordinate of the joints are uniform.
    pub(super) fn uniform_points(&self) -> Option<AllUniform> {
        self.uniform(|series| &series.ranks)
    }

    /// Whether the ranks of each degree of freedom are, where they are known.
    pub(super) fn uniform_state(&self) -> Option<AllUniform> {
        self.uniform(|series| &series.state_ranks)
    }

    /// Series with a warning of each kind, and with any.
    pub(super) fn warned(&self) -> (BTreeMap<String, usize>, usize) {
        let mut kinds = BTreeMap::new();
        for kind in self.all.iter().flat_map(|series| &series.doubts) {
            *kinds.entry(kind.clone()).or_insert(0) += 1;
        }
        (kinds, self.all.iter().filter(|series| !series.doubts.is_empty()).count())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(ranks: impl Fn(u32) -> u32) -> Found {
        let series = |i: u32| Series {
            ranks: vec![ranks(i); 3],
            covered: vec![vec![f64::from(i % 2)]; ranks::LEVELS.len()],
            doubts: if i == 3 { vec!["offset".into()] } else { vec![] },
            ..Series::default()
        };
        Found::of(&(0..200).map(series).collect::<Vec<_>>())
    }

    #[test]
    fn uniform_ranks_pass_and_crowded_ones_do_not() {
        let uniform = all(|i| i);
        let found = uniform.uniform_points().unwrap();
        assert_eq!((found.coordinates, found.p, found.below), (3, 1.0, 0));
        assert!(uniform.uniform_state().is_none());
        assert!(uniform.histogram().iter().all(|[share, _]| (share - 1.0).abs() < 1e-12));
        let crowded = all(|i| 50 + i / 2).uniform_points().unwrap();
        assert!(crowded.p < 1e-6 && crowded.below == 3, "{crowded:?}");
    }

    #[test]
    fn coverages_are_means_over_series() {
        let found = all(|i| i);
        let [share, error] = found.pooled_at(0.9);
        // 200 series that are covered or not: √(¼/200).
        assert!((share - 0.5).abs() < 1e-12 && (error / 0.0354 - 1.0).abs() < 0.15, "{share} {error}");
        assert_eq!(found.warned(), (BTreeMap::from([("offset".to_owned(), 1)]), 1));
    }
}
