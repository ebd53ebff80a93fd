//! Draws of a density by trajectories with jumps, in one call: for densities of several modes.

use super::kernel::{Jumps, draw_with_jumps};
use crate::Error;
use crate::chains::{ChainDraws, Schedule, draw_trajectories};
use crate::density::Density;
use crate::gaussian_mixture::GaussianMixture;
use crate::nuts::transition::MAX_DEPTH;
use crate::run::Run;
use crate::sampling::{Plan, Starts, blocks, named};
use sinew_core::diagnostics::effective_sample_size;
use sinew_core::lanes::LANES;

/// How [`sample`] runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Chains; the modes that some chain starts in are the ones that jumps know.
    pub chains: usize,
    /// Draws that are kept of each chain.
    pub draws: usize,
    /// No-U-turn transitions of each chain that learn the metric, at least 170.
    pub warm_up: usize,
    /// The same seed gives the same draws, whatever the number of threads.
    pub seed: u64,
    /// Where chains start.
    pub starts: Starts,
    /// Acceptance that the step size of the trajectories aims at.
    pub acceptance: f64,
    /// Whether the draws of the warm-up are kept, in [`Run::warm_up`].
    pub keep_warm_up: bool,
    /// Leapfrog steps of the trajectory between jumps.
    pub leapfrog_steps: usize,
    /// Rounds of eight proposals after each trajectory.
    pub jumps: usize,
    /// Components of the mixture that proposes.
    pub components: usize,
    /// Updates of each chain to which the mixture is fitted, twice: without jumps, and with those of the first fit.
    pub fitting: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            chains: 8,
            draws: 1000,
            warm_up: 1000,
            seed: 0,
            starts: Starts::default(),
            acceptance: 0.9,
            keep_warm_up: false,
            leapfrog_steps: 8,
            jumps: 1,
            components: 4,
            fitting: 400,
        }
    }
}

/// Samples a density by Hamiltonian trajectories, each followed by independence proposals of a mixture that is fitted to draws of the same chains and then fixed.
///
/// # Errors
/// As [`crate::hmc::sample`]; [`Error::OutOfRange`] where the fitting draws are worth fewer than the components.
pub fn sample(density: &dyn Density, settings: Settings) -> Result<Run, Error> {
    let Settings { chains, draws, warm_up, seed, ref starts, acceptance, keep_warm_up, .. } = settings;
    let Settings { leapfrog_steps, jumps: count, components, fitting, .. } = settings;
    let plan = Plan { chains, draws, warm_up, keep_warm_up, acceptance, max_depth: MAX_DEPTH, starts, seed };
    plan.run(density, |warm| {
        let (hmc, tuned, states) = warm.tuned(&[leapfrog_steps], acceptance, 0.2)?;
        let schedule = Schedule { updates: fitting, burn_in: 1.min(fitting) };
        let dim = warm.full.dim();
        let fit = |draws: &ChainDraws| {
            // Chain after chain, so that components start in different ones.
            let run = Run::from_blocks(density.names(), draws);
            let states: Vec<Vec<f64>> = run.iter().map(<[f64]>::to_vec).collect();
            // Chains that stay in modes of their own tell much of the modes: each is worth what it is alone.
            let alone = |j: usize| run.series(j).iter().map(|chain| effective_sample_size(&[chain])).sum::<f64>();
            let worth = (0..dim).map(alone).fold(f64::INFINITY, f64::min);
            GaussianMixture::fit(warm.isa, &blocks(&states, LANES), dim, components, worth)
        };
        let round = |k: usize| warm.drawing.round(k);
        let plain = draw_trajectories(warm.full, &hmc, &states, states.len() / dim * LANES, schedule, &round(1))?;
        let rough = Jumps { proposal: fit(&plain)?, count };
        let states = plain.last;
        let second =
            draw_with_jumps(warm.full, &hmc, &rough, &states, states.len() / dim * LANES, schedule, &round(2))?;
        let fitted = Jumps { proposal: fit(&second.draws)?, count };
        let states = &second.draws.last;
        let run = draw_with_jumps(warm.full, &hmc, &fitted, states, chains, warm.schedule, &round(3))?;
        let (step_size, leapfrog_steps) = (tuned.step_size, tuned.leapfrog_steps);
        Ok(Run { step_size, leapfrog_steps, ..named(density, &run.draws)? })
    })
}
