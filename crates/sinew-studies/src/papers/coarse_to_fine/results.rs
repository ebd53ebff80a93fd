//! What stored cells say: means over frames with their errors over seeds, and paired differences.

use super::contender::Contender;
use crate::papers::seed_results::{Keyed, ONE_SIDED, REPLICATES, Results, differences};
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use sinew_simulate::segmentation_noise::Level;
use sinew_tests::evaluation::block_bootstrap;

/// Frames of a block of the bootstrap: 1 s.
pub(super) const BLOCK: usize = 60;

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

/// A contender on a level of noise.
struct OnLevel<'a>(Level, &'a Contender);

impl Keyed for OnLevel<'_> {
    fn key(&self, seed: u64) -> String {
        self.1.key(self.0, seed)
    }
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
    /// A number of each seed's cell.
    pub(super) fn numbers(&self, level: Level, contender: &Contender, name: &str) -> Outcome<Vec<f64>> {
        let of = |seed| Ok(self.cell(&OnLevel(level, contender), seed)?[name].as_f64().unwrap_or(f64::NAN));
        (1..=self.seeds).map(of).collect()
    }

    /// Whether the coarse particles of all seeds stood on centres.
    pub(super) fn on_centres(&self, level: Level, contender: &Contender) -> Outcome<bool> {
        let of = |seed| Ok(self.cell(&OnLevel(level, contender), seed)?["on_centres"] == true);
        Ok((1..=self.seeds).map(of).collect::<Outcome<Vec<bool>>>()?.into_iter().all(|all| all))
    }

    /// A quantity of an estimate frame by frame, one series a seed.
    pub(super) fn estimated(&self, level: Level, of: &Contender, by: Estimate, name: &str) -> Outcome<Vec<Vec<f64>>> {
        self.series(&OnLevel(level, of), &format!("/{}/{name}", by.name()))
    }

    /// Means over frames, one a seed.
    pub(super) fn means(&self, level: Level, of: &Contender, by: Estimate, name: &str) -> Outcome<Vec<f64>> {
        Ok(self.estimated(level, of, by, name)?.iter().map(mean).collect())
    }

    /// The quantity of one minus that of the other, both of the second estimate.
    pub(super) fn gap(&self, level: Level, [a, b]: [&Contender; 2], name: &str) -> Outcome<Difference> {
        let [a, b] = [a, b].map(|of| self.estimated(level, of, Estimate::Second, name));
        Ok(difference(&differences(&a?, &b?)))
    }
}

/// Mean, bound and sign of series of differences.
fn difference(series: &[Vec<f64>]) -> Difference {
    let all: Vec<f64> = series.iter().flatten().copied().collect();
    let value = mean(&all);
    let above = all.iter().filter(|x| **x > 0.0).count() as f64 / all.len() as f64;
    Difference { value, low: value - ONE_SIDED * block_bootstrap(series, BLOCK, REPLICATES, 1), above }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::seed_results::Mean;

    #[test]
    fn differences_have_a_mean_a_bound_and_a_sign() {
        let series = vec![(0..120).map(|k| f64::from(k % 4) - 1.0).collect::<Vec<f64>>(); 3];
        let found = difference(&series);
        assert!((found.value - 0.5).abs() < 1e-12 && (found.above - 0.5).abs() < 1e-12);
        // Blocks of whole periods all have the same mean.
        assert!((found.low - 0.5).abs() < 1e-12, "{}", found.low);
        let Mean { value, error } = Mean::of(&[1.0, 3.0]);
        assert_eq!((value, error), (2.0, 1.0));
    }
}
