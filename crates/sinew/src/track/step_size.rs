//! Step size and trajectory length of Hamiltonian Monte Carlo for a recording.

use super::error::TrackError;
use super::motion_prior::motion_prior;
use super::scene::Scene;
use crate::Error;
use crate::config::settings::Settings;
use crate::input::source::FrameSource;
use crate::methods::{FrameLikelihood, Gives, Making};
use crate::setup::Setup;
use sinew_body::KinematicTree;
use sinew_core::random::Stage;

/// Step size and trajectory length for a recording, from its first frames: the last value of the set-up pass, for methods that have them.
///
/// # Errors
/// Errors of the source; no step size found.
pub fn tune(
    setup: &mut Setup,
    tree: &KinematicTree,
    source: &mut dyn FrameSource,
    number: u64,
    settings: &Settings,
) -> Result<(), Error> {
    if settings.method.about().gives != Gives::Chains {
        return Ok(());
    }
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let mut scene = Scene::new(setup, tree, &cameras, &layout, settings)?;
    let prior = motion_prior(setup, tree, settings)?;
    // Spread of the prior in the middle of a recording, where step sizes are tuned: that of one step of motion.
    let steady_sd = prior.sd().to_vec();
    let transition = prior.with_initial_sd(steady_sd).map_err(TrackError::Motion)?;
    let start = scene.start().to_vec();
    let (observed, found) = scene.observe(&source.people(number)?, &[], &start);
    let start = found.unwrap_or(start);
    let dt = 1.0 / settings.fps;
    let (latent, isa) = (settings.latent_model.as_deref(), settings.isa);
    let names = scene.keypoints();
    let making =
        Making { setup, transition: &transition, parts: None, motion_model: None, latent, keypoints: &names, dt, isa };
    let stage = Stage::new(settings.seed, "set-up");
    let likelihood = FrameLikelihood::from(observed);
    if let Some(found) = settings.method.tuned(&making, start, &likelihood, stage)? {
        setup.step_size = Some(found.step_size);
        setup.leapfrog_steps = u32::try_from(found.leapfrog_steps).ok();
    }
    Ok(())
}
