//! What stored cells say: means over frames with their errors over seeds, and paired differences.

use super::contender::Contender;
use crate::support::outcome::Outcome;
use crate::support::store::{Store, numbers};
use serde_json::Value;
use sinew_simulate::segmentation_noise::Level;
use sinew_tests::evaluation::block_bootstrap;
use sinew_tests::finding::mean_and_error;

/// Frames of a block of the bootstrap: 1 s.
const BLOCK: usize = 60;
/// Replicates of the bootstrap.
const REPLICATES: usize = 2000;
/// One-sided 95 % of a normal distribution, in standard errors.
const ONE_SIDED: f64 = 1.645;

/// Which of the two estimates of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Estimate {
    /// X_c, or the particle of the largest weight.
    First,
    /// X̂, or the weighted mean.
    Second,
}

impl Estimate {
    const fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Second => "second",
        }
    }
}

/// Name of a level.
pub(super) fn level_name(level: Level) -> &'static str {
    Level::ALL.iter().find(|(_, of)| *of == level).map_or("", |(name, _)| name)
}

/// Finished cells of some seeds.
#[derive(Clone, Copy)]
pub(super) struct Results<'a> {
    pub(super) store: &'a Store,
    pub(super) seeds: &'a [u64],
}

/// A mean and its standard error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean {
    pub(super) value: f64,
    pub(super) error: f64,
}

/// Mean and standard error of values of independent runs; a single run has none.
pub(super) fn mean(values: &[f64]) -> Mean {
    let [value, error] = mean_and_error(values);
    Mean { value, error: if values.len() > 1 { error } else { 0.0 } }
}

/// A difference of series that are paired by seed and frame.
pub(super) struct Difference {
    pub(super) value: f64,
    /// Lower end of the one-sided 95 % interval, by a bootstrap of blocks of a second within each seed's series.
    pub(super) low: f64,
    /// Share of frames in which it is above zero.
    pub(super) above: f64,
}

impl Results<'_> {
    fn cell(&self, level: Level, contender: &Contender, seed: u64) -> Outcome<&Value> {
        let key = contender.key(level, seed);
        Ok(self.store.get(&key).ok_or(format!("the cell {key} is missing"))?)
    }

    /// A number of each seed's cell.
    pub(super) fn numbers(&self, level: Level, contender: &Contender, name: &str) -> Outcome<Vec<f64>> {
        let of = |&seed: &u64| Ok(self.cell(level, contender, seed)?[name].as_f64().unwrap_or(f64::NAN));
        self.seeds.iter().map(of).collect()
    }

    /// Whether the coarse particles of all seeds stood on centres.
    pub(super) fn on_centres(&self, level: Level, contender: &Contender) -> Outcome<bool> {
        let of = |&seed: &u64| Ok(self.cell(level, contender, seed)?["on_centres"] == true);
        Ok(self.seeds.iter().map(of).collect::<Outcome<Vec<bool>>>()?.into_iter().all(|all| all))
    }

    /// A quantity frame by frame, one series a seed.
    pub(super) fn series(
        &self,
        level: Level,
        contender: &Contender,
        estimate: Estimate,
        name: &str,
    ) -> Outcome<Vec<Vec<f64>>> {
        let of = |&seed: &u64| Ok(numbers(&self.cell(level, contender, seed)?[estimate.name()][name]));
        self.seeds.iter().map(of).collect()
    }

    /// Means over frames, one a seed.
    pub(super) fn means(
        &self,
        level: Level,
        contender: &Contender,
        estimate: Estimate,
        name: &str,
    ) -> Outcome<Vec<f64>> {
        let all = self.series(level, contender, estimate, name)?;
        Ok(all.iter().map(|series| mean(series).value).collect())
    }

    /// The quantity of one minus that of the other, both of the second estimate.
    pub(super) fn difference(&self, level: Level, [a, b]: [&Contender; 2], name: &str) -> Outcome<Difference> {
        let [a, b] = [a, b].map(|of| self.series(level, of, Estimate::Second, name));
        let (a, b) = (a?, b?);
        let pairs = a.iter().zip(&b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect());
        Ok(difference(&pairs.collect::<Vec<Vec<f64>>>()))
    }
}

/// Mean, bound and sign of series of differences.
fn difference(series: &[Vec<f64>]) -> Difference {
    let all: Vec<f64> = series.iter().flatten().copied().collect();
    let value = mean(&all).value;
    let above = all.iter().filter(|x| **x > 0.0).count() as f64 / all.len() as f64;
    Difference { value, low: value - ONE_SIDED * block_bootstrap(series, BLOCK, REPLICATES, 1), above }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_have_a_mean_a_bound_and_a_sign() {
        let series = vec![(0..120).map(|k| f64::from(k % 4) - 1.0).collect::<Vec<f64>>(); 3];
        let found = difference(&series);
        assert!((found.value - 0.5).abs() < 1e-12 && (found.above - 0.5).abs() < 1e-12);
        // Blocks of whole periods all have the same mean.
        assert!((found.low - 0.5).abs() < 1e-12, "{}", found.low);
        let Mean { value, error } = mean(&[1.0, 3.0]);
        assert_eq!((value, error), (2.0, 1.0));
    }
}
