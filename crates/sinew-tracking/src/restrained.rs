//! The hybrid Monte Carlo filter with one more factor of the prior in every frame.
//!
//! The factor stays as it is where errors of the observation are broadened: as [`crate::with_prior`], but the search for a frame's mode keeps its detour through broadened errors ([`GaussNewton::broadened`]): the factor is added to the broadened observation. The factor need not be
//! normalised; so a step has no evidence.

use crate::hmc_filter::HmcFilter;
use crate::posterior::Posterior;
use crate::{Error, Resume, StepInfo, Tracker};
use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::Block;
use sinew_core::random::Stage;
use sinew_core::transition::Predict;

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

/// The filter.
pub struct RestrainedFilter<T, P> {
    /// The filter that takes its steps.
    pub filter: HmcFilter<T>,
    /// The factor.
    pub prior: P,
}

impl<T: Predict + Send, P: GaussNewton + Send, O: GaussNewton> Tracker<O> for RestrainedFilter<T, P> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let info = self.filter.step(&Restrained(Sum(observed, &self.prior)), stage)?;
        Ok(StepInfo { log_evidence: None, ..info })
    }

    fn posterior(&self) -> Posterior<'_> {
        Tracker::<O>::posterior(&self.filter)
    }

    fn estimate(&self) -> &[f64] {
        Tracker::<O>::estimate(&self.filter)
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
