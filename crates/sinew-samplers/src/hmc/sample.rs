//! Draws of a density by trajectories of fixed length, in one call.

use crate::Error;
use crate::chains::draw_trajectories;
use crate::density::Density;
use crate::nuts::MAX_DEPTH;
use crate::run::Run;
use crate::sampling::{Plan, Starts, named};

/// How [`sample`] runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Chains.
    pub chains: usize,
    /// Draws that are kept of each chain.
    pub draws: usize,
    /// No-U-turn transitions of each chain that learn the metric, at least 170.
    pub warm_up: usize,
    /// The same seed gives the same draws, whatever the number of threads.
    pub seed: u64,
    /// Where chains start.
    pub starts: Starts,
    /// Acceptance that the step size aims at.
    pub acceptance: f64,
    /// Whether the draws of the warm-up are kept, in [`Run::warm_up`].
    pub keep_warm_up: bool,
    /// Lengths of trajectories in leapfrog steps that are tried out; the cheapest by effective draw is taken.
    pub lengths: Vec<usize>,
    /// Steps are multiplied by a number uniform in 1 ± jitter, one a trajectory: a fixed length near half a period would turn means about and leave spreads where they are.
    pub jitter: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            chains: 4,
            draws: 1000,
            warm_up: 1000,
            seed: 0,
            starts: Starts::default(),
            acceptance: 0.9,
            keep_warm_up: false,
            lengths: vec![4, 8, 16, 32],
            jitter: 0.5,
        }
    }
}

/// Samples a density by Hamiltonian trajectories with a learned dense metric and a tuned length ([`crate::tuning`]).
///
/// # Errors
/// As [`crate::nuts::sample`]; [`Error::StepSizeNotFound`].
pub fn sample(density: &dyn Density, settings: Settings) -> Result<Run, Error> {
    let Settings { chains, draws, warm_up, seed, ref starts, acceptance, keep_warm_up, ref lengths, jitter } = settings;
    let plan = Plan { chains, draws, warm_up, keep_warm_up, acceptance, max_depth: MAX_DEPTH, starts, seed };
    plan.run(density, |warm| {
        let (hmc, tuned, _) = warm.tuned(lengths, acceptance, jitter)?;
        let draws = draw_trajectories(warm.target, &hmc, &warm.warmed.states, chains, warm.schedule, &warm.drawing)?;
        let (step_size, leapfrog_steps) = (tuned.step_size, tuned.leapfrog_steps);
        Ok(Run { step_size, leapfrog_steps, ..named(density, &draws)? })
    })
}
