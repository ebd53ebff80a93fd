//! What stored cells say: means over frames with their errors over seeds.

use super::contender::{Contender, Motion};
use super::motions::TEST_TRIALS;
use super::worth::{Errors, kept, mean};
use crate::outcome::Outcome;
use crate::store::{Store, numbers};
use serde_json::Value;
use sinew_tests::evaluation::block_bootstrap;
use sinew_tests::finding::mean_and_error;
use std::ops::Range;

/// Frames of a block of the bootstrap: 1 s.
const BLOCK: usize = 20;
const REPLICATES: usize = 2000;
/// One-sided 95 % in standard errors: of a normal distribution, and of Student's with a degree of freedom for all test trials but one.
const ONE_SIDED: f64 = 1.645;
const OVER_TRIALS: f64 = 1.771;

/// Finished cells of some seeds.
#[derive(Clone, Copy)]
pub(super) struct Results<'a> {
    pub(super) store: &'a Store,
    pub(super) seeds: u64,
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
        format!("{:.decimals$} ± {:.decimals$}", self.value, self.error)
    }
}

impl Results<'_> {
    fn cell(&self, contender: &Contender, seed: u64) -> Outcome<&Value> {
        let key = contender.key(seed);
        Ok(self.store.get(&key).ok_or(format!("the cell {key} is missing"))?)
    }

    /// A quantity frame by frame, by seed; `path` is its JSON pointer.
    pub(super) fn series(&self, contender: &Contender, path: &str) -> Outcome<Vec<Vec<f64>>> {
        let of = |seed| Ok(numbers(self.cell(contender, seed)?.pointer(path).unwrap_or(&Value::Null)));
        (1..=self.seeds).map(of).collect()
    }

    /// Mean over some frames, all if `None`.
    pub(super) fn mean(&self, contender: &Contender, path: &str, frames: Option<&Range<usize>>) -> Outcome<Mean> {
        let all = self.series(contender, path)?;
        let of = |series: &Vec<f64>| match frames {
            Some(frames) => mean(&series[frames.start.min(series.len())..frames.end.min(series.len())]),
            None => mean(series),
        };
        Ok(Mean::of(&all.iter().map(of).collect::<Vec<f64>>()))
    }

    /// A quantity of a contender in each test trial, whatever motion it is on.
    fn by_trial<T>(&self, contender: &Contender, of: impl Fn(&Self, &Contender) -> Outcome<T>) -> Outcome<Vec<T>> {
        (0..TEST_TRIALS.len()).map(|k| of(self, &contender.moved(Motion::Trial(k)))).collect()
    }

    /// Mean over frames and seeds of a quantity in each test trial.
    fn means_by_trial(&self, contender: &Contender, path: &str) -> Outcome<Vec<f64>> {
        self.by_trial(contender, |results, on_trial| Ok(results.mean(on_trial, path, None)?.value))
    }

    /// Mean over the test trials, each with the same weight; the error is over trials.
    pub(super) fn over_trials(&self, contender: &Contender, path: &str) -> Outcome<Mean> {
        Ok(Mean::of(&self.means_by_trial(contender, path)?))
    }

    /// How many runs of the test trials keep the person, of how many.
    pub(super) fn trials_kept(&self, contender: &Contender) -> Outcome<[usize; 2]> {
        let kept = self.by_trial(contender, |results, on_trial| Ok(results.kept(on_trial)?.1))?;
        Ok([kept.iter().sum(), kept.len() * self.seeds as usize])
    }

    /// Milliseconds of processor time a frame, over the test trials.
    pub(super) fn ms_over_trials(&self, contender: &Contender) -> Outcome<Mean> {
        Ok(Mean::of(&self.by_trial(contender, |results, on_trial| Ok(results.ms(on_trial)?.value))?))
    }

    /// Mean difference of the relative errors of two contenders, paired by trial, and its one-sided 95 % reach over trials.
    pub(super) fn difference_over_trials(&self, a: &Contender, b: &Contender) -> Outcome<[f64; 2]> {
        let (a, b) = (self.means_by_trial(a, "/relative")?, self.means_by_trial(b, "/relative")?);
        let Mean { value, error } = Mean::of(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>());
        Ok([value, OVER_TRIALS * error])
    }

    /// Milliseconds of processor time a frame.
    pub(super) fn ms(&self, contender: &Contender) -> Outcome<Mean> {
        let of = |seed| Ok(self.cell(contender, seed)?["ms"].as_f64().unwrap_or(f64::NAN));
        Ok(Mean::of(&(1..=self.seeds).map(of).collect::<Outcome<Vec<f64>>>()?))
    }

    /// The limb ratio, and how many seeds keep the person.
    pub(super) fn kept(&self, contender: &Contender) -> Outcome<(Mean, usize)> {
        let (mut ratios, mut all) = (vec![], 0);
        for seed in 1..=self.seeds {
            let cell = self.cell(contender, seed)?;
            let of = |name: &str| numbers(&cell[name]);
            let found = Errors { absolute: of("absolute"), relative: of("relative"), limbs: of("limbs") };
            let limbs = of("mean_pose_limbs");
            let (_, ratio, is_kept) = kept(&found, &Errors { absolute: vec![], relative: vec![], limbs });
            ratios.push(ratio);
            all += usize::from(is_kept);
        }
        Ok((Mean::of(&ratios), all))
    }

    /// Mean difference of the relative errors of two contenders, paired by seed and frame, and the upper end of its one-sided 95 % interval by blocks of a second.
    pub(super) fn difference(&self, a: &Contender, b: &Contender) -> Outcome<[f64; 2]> {
        let (a, b) = (self.series(a, "/relative")?, self.series(b, "/relative")?);
        let pairs = a.iter().zip(&b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect());
        let series: Vec<Vec<f64>> = pairs.collect();
        let value = mean(&series.concat());
        Ok([value, value + ONE_SIDED * block_bootstrap(&series, BLOCK, REPLICATES, 1)])
    }
}
