//! Draws of a density by the no-U-turn sampler, in one call.

use super::{MAX_DEPTH, Nuts, draw_trees};
use crate::Error;
use crate::density::Density;
use crate::run::Run;
use crate::sampling::{Plan, Starts, named};

/// How [`sample`] runs; the default is Stan's.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Chains.
    pub chains: usize,
    /// Draws that are kept of each chain.
    pub draws: usize,
    /// Transitions of each chain that learn metric and step size, at least 170.
    pub warm_up: usize,
    /// The same seed gives the same draws, whatever the number of threads.
    pub seed: u64,
    /// Where chains start.
    pub starts: Starts,
    /// Acceptance that the step size aims at; nearer to 1 where trajectories diverge.
    pub acceptance: f64,
    /// Greatest depth of a tree, which has at most 2^depth states.
    pub max_depth: usize,
    /// Whether the draws of the warm-up are kept, in [`Run::warm_up`].
    pub keep_warm_up: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            chains: 4,
            draws: 1000,
            warm_up: 1000,
            seed: 0,
            starts: Starts::default(),
            acceptance: 0.8,
            max_depth: MAX_DEPTH,
            keep_warm_up: false,
        }
    }
}

/// Samples a density by no-U-turn trees with a learned dense metric.
///
/// # Errors
/// [`Error::Empty`], [`Error::Length`] and [`Error::OutOfRange`] for settings, [`Error::BadStart`] where the density vanishes, [`Error::Metric`] where a coordinate does not vary.
pub fn sample(density: &dyn Density, settings: Settings) -> Result<Run, Error> {
    let Settings { chains, draws, warm_up, seed, ref starts, acceptance, max_depth, keep_warm_up } = settings;
    let plan = Plan { chains, draws, warm_up, keep_warm_up, acceptance, max_depth, starts, seed };
    plan.run(density, |warm| {
        let step_size = warm.warmed.step_size;
        let nuts = Nuts::with_metric(step_size, &warm.warmed.metric, max_depth, 0.0, warm.isa)?;
        let run = draw_trees(warm.target, &nuts, &warm.warmed.states, chains, warm.schedule, &warm.drawing)?;
        Ok(Run { step_size, max_depth, ..named(density, &run.draws)? })
    })
}
