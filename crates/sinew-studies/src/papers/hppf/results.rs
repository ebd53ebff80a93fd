//! What the cells of the test trials say together, with trials as units.

use super::contender::{Contender, Motion};
use crate::papers::recorded_trials::TEST_TRIALS;
use crate::papers::seed_results::{Mean, Results};
use crate::support::outcome::Outcome;

/// One-sided 95 % in standard errors, of Student's distribution with a degree of freedom for all test trials but one.
const OVER_TRIALS: f64 = 1.771;

impl Results<'_> {
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
}
