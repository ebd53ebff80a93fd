//! One chain of Hamiltonian Monte Carlo as a Markov kernel: a block whose first lane counts.
//!
//! Eight chains cost as much as one; use [`crate::hmc::update`] where there are several.

use crate::hmc::kernel::{Chains, Hmc, Workspace, update};
use sinew_core::density::GradLogDensity;
use sinew_core::kernel::{Invariant, MarkovKernel};
use sinew_core::lanes::{Block, get_lane};
use sinew_core::random::BlockRng;

/// Kernel that moves one state by one trajectory on its target.
#[derive(Clone, Debug)]
pub struct OneChain<T> {
    target: T,
    hmc: Hmc,
    chains: Option<Chains>,
    workspace: Workspace,
    divergences: usize,
}

impl<T: GradLogDensity> OneChain<T> {
    /// A kernel for `target`.
    #[must_use]
    pub fn new(target: T, hmc: Hmc) -> Self {
        let workspace = Workspace::new(&target);
        Self { target, hmc, chains: None, workspace, divergences: 0 }
    }

    /// Divergent trajectories so far.
    #[must_use]
    pub fn divergences(&self) -> usize {
        self.divergences
    }
}

impl<T: GradLogDensity> MarkovKernel for OneChain<T> {
    /// A state whose log density is not finite is left where it is and counts as a divergence.
    fn step(&mut self, state: &mut [f64], rng: &mut BlockRng) {
        let is_cached = |c: &Chains| c.position.iter().zip(&*state).all(|(b, x)| b.0[0] == *x);
        let chains = match self.chains.take().filter(is_cached) {
            Some(chains) => Ok(chains),
            None => Chains::new(&self.target, state.iter().map(|&x| Block::splat(x)).collect()),
        };
        let Ok(mut chains) = chains else {
            self.divergences += 1;
            return;
        };
        let moved = update(&self.target, &self.hmc, &mut chains, &mut self.workspace, rng);
        self.divergences += usize::from(moved.divergent[0]);
        get_lane(&chains.position, 0, state);
        self.chains = Some(chains);
    }
}

impl<T: GradLogDensity> Invariant for OneChain<T> {}
