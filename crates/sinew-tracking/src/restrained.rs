//! The hybrid Monte Carlo filter with one more factor of the prior in every frame.
//!
//! The factor stays as it is where errors of the observation are broadened: as [`crate::with_prior`], but the search for a frame's mode keeps its detour through broadened errors ([`GaussNewton::broadened`]): the factor is added to the broadened observation. The factor φ need not be
//! normalised: with the prior π of a frame, the evidence of its observation y is that of both, over what is left of the prior:
//!
//! ```text
//! p(y) = ∫ p(y | s) φ(s) π(s) ds / ∫ φ(s) π(s) ds
//! ```
//!
//! and the latter is a mean over draws of π.

use crate::hmc_filter::HmcFilter;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::{FramePrior, Predict};

/// A frame's likelihood times a factor.
pub struct Restrained<'a, P>(pub Sum<&'a dyn GaussNewton, &'a P>);

impl<P: GaussNewton> LogDensity for Restrained<'_, P> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn workspace(&self) -> usize {
        self.0.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.0.log_density(x)
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.0.log_density_block(x, ws)
    }
}

impl<P: GaussNewton> GradLogDensity for Restrained<'_, P> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.0.log_density_grad(x, grad)
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        self.0.log_density_grad_block(x, grad, ws)
    }
}

impl<P: GaussNewton> GaussNewton for Restrained<'_, P> {
    fn matrix_workspace(&self) -> usize {
        self.0.matrix_workspace()
    }
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.0.gauss_newton_diagonal_block(x, diagonal, ws);
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.0.gauss_newton_block(x, matrix, ws);
    }
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.0.weighted_gauss_newton_block(x, matrix, ws);
    }
    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        let Sum(observed, prior) = &self.0;
        Some(Box::new(Sum(observed.broadened(factor)?, *prior)))
    }
}

/// Blocks of draws of a prior by which a factor is weighed.
const BLOCKS: usize = 32;

/// The logarithm of the mean of exp(`factor`) over draws of a prior.
fn log_mean(factor: &impl LogDensity, prior: &impl FramePrior, stage: Stage) -> f64 {
    let (mut state, mut ws) = (vec![Block::ZERO; factor.dim()], vec![Block::ZERO; factor.workspace()]);
    let mut logs = Vec::with_capacity(BLOCKS * LANES);
    for block in 0..BLOCKS {
        prior.sample_block(block, &mut state, &mut stage.block(block as u32));
        logs.extend(factor.log_density_block(&state, &mut ws).0);
    }
    let largest = logs.iter().fold(f64::NEG_INFINITY, |largest, log| largest.max(*log));
    if largest.is_finite() {
        largest + (logs.iter().map(|log| (log - largest).exp()).sum::<f64>() / logs.len() as f64).ln()
    } else {
        largest
    }
}

/// The filter.
pub struct RestrainedFilter<T, P> {
    /// The filter that takes its steps.
    pub filter: HmcFilter<T>,
    /// The factor.
    pub prior: P,
}

impl<T: Predict + Send, P: GaussNewton + Send, O: GaussNewton> Tracker<O> for RestrainedFilter<T, P> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let [to_step, to_weigh] = stage.split(["step", "factor"]);
        let left = log_mean(&self.prior, &self.filter.prior()?, to_weigh);
        let info = self.filter.step(&Restrained(Sum(observed, &self.prior)), to_step)?;
        Ok(StepInfo { log_evidence: info.log_evidence.map(|both| both - left), ..info })
    }
}

impl<T: Predict, P> Inferred for RestrainedFilter<T, P> {
    fn posterior(&self) -> Posterior<'_> {
        self.filter.posterior()
    }

    fn estimate(&self) -> &[f64] {
        self.filter.estimate()
    }
}

impl<T: Predict, P> Resume for RestrainedFilter<T, P> {
    fn save(&self) -> Vec<f64> {
        self.filter.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.filter.restore(saved)
    }
}
