//! The tracker of a run from its settings.

use super::method::Method;
use super::restart::Steps;
use super::settings::Settings;
use crate::Error;
use crate::setup::Setup;
use sinew_core::part::PartTree;
use sinew_dynamics::random_walk::RandomWalk;
use sinew_samplers::grid::Axis;
use sinew_tracking::{annealed, bootstrap, coarse_to_fine, hmc_filter, partitioned};

pub(super) fn hmc_config(setup: &Setup, settings: &Settings) -> hmc_filter::Config {
    let preset = hmc_filter::Config::real_recordings();
    hmc_filter::Config {
        chains: settings.chains,
        updates: settings.updates,
        burn_in: settings.burn_in,
        jitter: settings.jitter,
        step_size: setup.step_size.unwrap_or(preset.step_size),
        leapfrog_steps: setup.leapfrog_steps.map_or(preset.leapfrog_steps, |l| l as usize),
        ..preset
    }
}

/// A tracker that starts at a state; methods that take the body part by part need its parts.
pub fn tracker(
    setup: &Setup,
    settings: &Settings,
    transition: &RandomWalk,
    parts: Option<&PartTree>,
    start: Vec<f64>,
) -> Result<Box<dyn Steps>, Error> {
    let parts = || parts.cloned().ok_or_else(|| Error::numerical("the body has no parts"));
    Ok(match settings.method {
        Method::Hmc => Box::new(
            hmc_filter::HmcFilter::new(hmc_config(setup, settings), transition.clone(), start, settings.isa)
                .map_err(Error::numerical)?,
        ),
        Method::Bootstrap => {
            let config = bootstrap::Config { particles: settings.particles, ..bootstrap::Config::default() };
            Box::new(bootstrap::Bootstrap::new(config, transition.clone(), start).map_err(Error::numerical)?)
        }
        Method::Annealed => {
            let config = annealed::Config { particles: settings.particles, layers: settings.layers };
            let sd = transition.sd().to_vec();
            Box::new(
                annealed::Annealed::new(config, transition.clone(), sd, start, settings.isa)
                    .map_err(Error::numerical)?,
            )
        }
        Method::Partitioned => {
            let config = partitioned::Config { particles: settings.particles, ..partitioned::Config::default() };
            Box::new(
                partitioned::Partitioned::new(config, transition.clone(), parts()?, start).map_err(Error::numerical)?,
            )
        }
        Method::CoarseToFine => {
            let config = coarse_to_fine::Config {
                coarse: settings.particles,
                fine: settings.fine,
                ..coarse_to_fine::Config::default()
            };
            let axes = axes(&start, transition.sd()).map_err(Error::numerical)?;
            Box::new(
                coarse_to_fine::CoarseToFine::new(config, axes, parts()?, start, settings.isa)
                    .map_err(Error::numerical)?,
            )
        }
    })
}

/// Range of a position about where tracking began, metres, in which the coarse level has partitions.
const RANGE_M: f64 = 2.0;

/// Partitions of the coarse level: as wide as a step of motion, positions within [`RANGE_M`] of the start, angles all around.
fn axes(start: &[f64], sd: &[f64]) -> Result<Vec<Axis>, sinew_samplers::Error> {
    use std::f64::consts::PI;
    let axis = |(j, (&at, &sd)): (usize, (&f64, &f64))| match j {
        0..3 => Axis::new(at - RANGE_M, at + RANGE_M, sd, false),
        _ => Axis::new(-PI, PI, sd, true),
    };
    start.iter().zip(sd).enumerate().map(axis).collect()
}
