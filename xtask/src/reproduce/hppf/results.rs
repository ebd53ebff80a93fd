//! What the cells of the test trials say together, with trials as units.

use super::contender::{Contender, Method, Motion, on};
use crate::outcome::Outcome;
use crate::reproduce::recorded_trials::TEST_TRIALS;
use crate::reproduce::seed_results::{Keyed, Mean, Results};

/// One-sided 95 % in standard errors, of Student's distribution with a degree of freedom for all test trials but one.
const OVER_TRIALS: f64 = 1.771;

impl Keyed for Contender {
    fn key(&self, seed: u64) -> String {
        Self::key(self, seed)
    }
}

impl Results<'_> {
    /// Mean over frames and seeds of a quantity in each test trial.
    fn by_trial(&self, method: Method, path: &str) -> Outcome<Vec<f64>> {
        let trial = |k| Ok(self.mean(&on(method, Motion::Trial(k)), path, None)?.value);
        (0..TEST_TRIALS.len()).map(trial).collect()
    }

    /// Mean over the test trials, each with the same weight; the error is over trials.
    pub(super) fn over_trials(&self, method: Method, path: &str) -> Outcome<Mean> {
        Ok(Mean::of(&self.by_trial(method, path)?))
    }

    /// How many runs of the test trials keep the person, of how many.
    pub(super) fn trials_kept(&self, method: Method) -> Outcome<[usize; 2]> {
        let kept = |k| Ok(self.kept(&on(method, Motion::Trial(k)))?.1);
        let kept = (0..TEST_TRIALS.len()).map(kept).collect::<Outcome<Vec<usize>>>()?;
        Ok([kept.iter().sum(), kept.len() * self.seeds as usize])
    }

    /// Mean difference of the relative errors of two methods, paired by trial, and the upper end of its one-sided 95 % interval over trials.
    pub(super) fn difference_over_trials(&self, a: Method, b: Method) -> Outcome<[f64; 2]> {
        let (a, b) = (self.by_trial(a, "/relative")?, self.by_trial(b, "/relative")?);
        let Mean { value, error } = Mean::of(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>());
        Ok([value, value + OVER_TRIALS * error])
    }
}
