//! What stored cells of tracked motions say. Means over frames with their errors over seeds, differences, and whether the person is kept.

use super::worth::{Errors, kept};
use crate::support::outcome::Outcome;
use crate::support::statistics::{mean, mean_and_error};
use crate::support::store::{Store, numbers};
use crate::support::table::with_spread;
use serde_json::Value;
use sinew_tests::evaluation::block_bootstrap;
use std::ops::Range;

/// Replicates of a bootstrap.
pub(super) const REPLICATES: usize = 2000;
/// One-sided 95 % of a normal distribution, in standard errors.
pub(super) const ONE_SIDED: f64 = 1.645;

/// Whose cells are stored, one a seed.
pub(super) trait Keyed {
    /// The name of its cell with a seed.
    fn key(&self, seed: u64) -> String;
}

/// Finished cells of some seeds.
#[derive(Clone, Copy)]
pub(super) struct Results<'a> {
    pub(super) store: &'a Store,
    pub(super) seeds: u64,
    /// Frames of a block of the bootstrap: 1 s.
    pub(super) block: usize,
}

/// A mean over seeds and its standard error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean {
    pub(super) value: f64,
    pub(super) error: f64,
}

impl Mean {
    pub(super) fn of(values: &[f64]) -> Self {
        let [value, error] = mean_and_error(values);
        Self { value, error: if values.len() > 1 { error } else { 0.0 } }
    }

    /// With its error, as tables show it.
    pub(super) fn shown(&self, decimals: usize) -> String {
        with_spread([self.value, self.error], decimals)
    }
}

/// What series are more than others, pair by pair.
pub(super) fn differences(a: &[Vec<f64>], b: &[Vec<f64>]) -> Vec<Vec<f64>> {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect()).collect()
}

impl Results<'_> {
    pub(super) fn cell(&self, contender: &impl Keyed, seed: u64) -> Outcome<&Value> {
        let key = contender.key(seed);
        Ok(self.store.get(&key).ok_or(format!("the cell {key} is missing"))?)
    }

    /// A quantity frame by frame, by seed; `path` is its JSON pointer.
    pub(super) fn series(&self, contender: &impl Keyed, path: &str) -> Outcome<Vec<Vec<f64>>> {
        let of = |seed| Ok(numbers(self.cell(contender, seed)?.pointer(path).unwrap_or(&Value::Null)));
        (1..=self.seeds).map(of).collect()
    }

    /// Mean over some frames, all if `None`.
    pub(super) fn mean(&self, contender: &impl Keyed, path: &str, frames: Option<&Range<usize>>) -> Outcome<Mean> {
        let all = self.series(contender, path)?;
        let of = |series: &Vec<f64>| match frames {
            Some(frames) => mean(&series[frames.start.min(series.len())..frames.end.min(series.len())]),
            None => mean(series),
        };
        Ok(Mean::of(&all.iter().map(of).collect::<Vec<f64>>()))
    }

    /// Milliseconds of processor time a frame.
    pub(super) fn ms(&self, contender: &impl Keyed) -> Outcome<Mean> {
        let of = |seed| Ok(self.cell(contender, seed)?["ms"].as_f64().unwrap_or(f64::NAN));
        Ok(Mean::of(&(1..=self.seeds).map(of).collect::<Outcome<Vec<f64>>>()?))
    }

    /// The limb ratio, and how many seeds keep the person.
    pub(super) fn kept(&self, contender: &impl Keyed) -> Outcome<(Mean, usize)> {
        let found: Vec<_> = self.runs(contender)?.iter().map(|[run, mean_pose]| kept(run, mean_pose)).collect();
        let ratios: Vec<f64> = found.iter().map(|(_, ratio, _)| *ratio).collect();
        Ok((Mean::of(&ratios), found.iter().filter(|(.., is_kept)| *is_kept).count()))
    }

    /// Errors of each seed, with the mean pose's.
    pub(super) fn runs(&self, contender: &impl Keyed) -> Outcome<Vec<[Errors; 2]>> {
        let run = |seed| {
            let cell = self.cell(contender, seed)?;
            let of = |name: &str| numbers(&cell[name]);
            let found = Errors { absolute: of("absolute"), relative: of("relative"), limbs: of("limbs") };
            Ok([found, Errors { absolute: vec![], relative: vec![], limbs: of("mean_pose_limbs") }])
        };
        (1..=self.seeds).map(run).collect()
    }

    /// Mean difference of the relative errors of two contenders, paired by seed and frame, and the upper end of its one-sided 95 % interval by blocks of a second.
    pub(super) fn difference(&self, a: &impl Keyed, b: &impl Keyed) -> Outcome<[f64; 2]> {
        let series = differences(&self.series(a, "/relative")?, &self.series(b, "/relative")?);
        let value = mean(series.concat());
        Ok([value, value + ONE_SIDED * block_bootstrap(&series, self.block, REPLICATES, 1)])
    }
}
