//! Weighted resampling (MacCormick & Blake 1999; MacCormick & Isard 2000).
//!
//! States are chosen by an importance function, and what they represent stays.
//!
//! Of states s_i with weights π_i and an importance function g > 0:
//!
//! 1. ρ_i = g(s_i) / Σ_j g(s_j)
//! 2. k_1 … k_N are drawn with probabilities ρ
//! 3. the new states are s_(k_n), with weights (1/N) π_(k_n) / ρ_(k_n)
//!
//! Law `resampling_by_any_importance_represents_the_same`: E[(1/N) Σ_n π_(k_n) / ρ_(k_n) f(s_(k_n))] = Σ_i π_i f(s_i) for every f, exactly, if g is positive wherever π is. The new weights add up to 1 only on average; the
//! logarithm of their sum comes back beside the normalised ones, so that an evidence that is taken apart into factors stays unbiased.

use crate::Error;
use crate::particles::{Particles, select};
use crate::resample::Scheme;
use crate::weights::{effective_number, normalise};
use sinew_core::random::Stage;

/// What weighted resampling did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reselected {
    /// Logarithm of the sum of the new weights before they were normalised; 0 on average on the natural scale.
    pub log_sum: f64,
    /// Survival diagnostic D = 1 / Σ ρ²: how many states the importance function singles out from the rest.
    pub survivors: f64,
}

/// Chooses the states again by the exponentials of `log_importance`, one a state, and weighs them so that they represent what they did.
///
/// # Errors
/// [`Error::BadWeight`] or [`Error::AllWeightsZero`], of the importance or of the weights that it leaves; nothing has changed then.
pub fn weighted_resample(
    particles: &mut Particles,
    log_importance: &[f64],
    scheme: Scheme,
    stage: Stage,
) -> Result<Reselected, Error> {
    let mut rho = Vec::new();
    let log_total = normalise(log_importance, &mut rho)?;
    let count = particles.count();
    let ancestors = scheme.ancestors(&rho, count, &mut stage.whole());
    let weight = |&k: &usize| particles.log_weights()[k] - (log_importance[k] - log_total) - (count as f64).ln();
    let log_weights: Vec<f64> = ancestors.iter().map(weight).collect();
    let log_sum = select(particles, ancestors, &log_weights)?;
    Ok(Reselected { log_sum, survivors: effective_number(&rho) })
}
