//! Step size and trajectory length of Hamiltonian Monte Carlo for a recording.

use super::motion_prior::walk;
use super::scene::Scene;
use super::settings::Settings;
use super::trackers::hmc_config;
use crate::Error;
use crate::input::source::FrameSource;
use crate::setup::{Setup, motion_noise};
use sinew_body::KinematicTree;
use sinew_core::random::Stage;
use sinew_samplers::tuning;
use sinew_tracking::hmc_filter;

/// Trajectory lengths to choose from. In units of the dense metric a trajectory should take a quarter to half of a period, 2π; longer ones come back to where they began.
const LENGTHS: [usize; 2] = [6, 7];

/// Step size and trajectory length for a recording, from its first frames: the last value of the set-up pass.
///
/// # Errors
/// Those of the source; no step size found.
pub fn tune(
    setup: &mut Setup,
    tree: &KinematicTree,
    source: &mut dyn FrameSource,
    number: u64,
    settings: &Settings,
) -> Result<(), Error> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let mut scene = Scene::new(setup, tree, &cameras, &layout, settings)?;
    let transition =
        walk(setup, tree, settings)?.with_initial_sd(steady_sd(setup, tree, settings)).map_err(Error::numerical)?;
    let start = scene.start().to_vec();
    let (observed, found) = scene.observe(&source.people(number)?, &start);
    let start = found.unwrap_or(start);
    let filter = hmc_filter::HmcFilter::new(hmc_config(setup, settings), transition, start, settings.isa)
        .map_err(Error::numerical)?;
    let config = tuning::Config { jitter: settings.jitter, lengths: LENGTHS.to_vec(), ..tuning::Config::default() };
    let tuned = filter.tune(&observed, &config, Stage::new(settings.seed, "set-up")).map_err(Error::numerical)?;
    setup.step_size = Some(tuned.step_size);
    setup.leapfrog_steps = u32::try_from(tuned.leapfrog_steps).ok();
    Ok(())
}

/// Spread of the prior in the middle of a recording, where step sizes are tuned: that of one step of motion.
fn steady_sd(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Vec<f64> {
    walk(setup, tree, settings).map_or_else(|_| motion_noise::initial_sd(tree), |walk| walk.sd().to_vec())
}
