//! A tracker with one more factor of the prior in every frame.
//!
//! The factor says what is known of a state whatever came before, such as where the latents of poses lie.
//!
//! The tracker steps on p(z_t | x) π(x), so that what it keeps is p(x | x_{t−1}) p(z_t | x) π(x) up to a constant. The factor need not be normalised; so a step has no evidence.

use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Sum;
use sinew_core::density::LogDensity;
use sinew_core::random::Stage;

/// The tracker.
#[derive(Clone, Debug)]
pub struct WithPrior<P, K> {
    /// log π.
    pub prior: P,
    /// The tracker that takes its steps.
    pub tracker: K,
}

impl<O, P, K> Tracker<O> for WithPrior<P, K>
where
    O: LogDensity + ?Sized,
    P: Send + Sync,
    K: for<'a> Tracker<Sum<&'a O, &'a P>>,
{
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let info = self.tracker.step(&Sum(observed, &self.prior), stage)?;
        Ok(StepInfo { log_evidence: None, ..info })
    }
}

impl<P, K: Inferred> Inferred for WithPrior<P, K> {
    fn posterior(&self) -> Posterior<'_> {
        self.tracker.posterior()
    }

    fn estimate(&self) -> &[f64] {
        self.tracker.estimate()
    }
}

impl<P, K: Resume> Resume for WithPrior<P, K> {
    fn save(&self) -> Vec<f64> {
        self.tracker.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.tracker.restore(saved)
    }
}
