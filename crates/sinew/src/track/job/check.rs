//! Settings that cannot be carried out, found before anything is claimed or computed.

use super::begin::{known_setup, same_body};
use super::level::world_up;
use crate::config::Resolved;
use crate::config::common::BODY;
use crate::track::{check_latent_model, check_model};
use crate::{Error, bodies};

/// Refuses settings that this processor, each other or the files that they name contradict.
///
/// # Errors
/// What a run would say of them later, and that a file cannot be read.
pub fn check_settings(resolved: &Resolved) -> Result<(), Error> {
    let config = resolved.track();
    let settings = resolved.settings()?;
    let known = known_setup(&config)?;
    let known = known.as_ref().map(|known| &known.setup);
    match known.filter(|_| resolved.is_given(BODY.key)) {
        Some(setup) => same_body(&config.body, setup)?,
        None => drop(bodies::to_track(&config.body)?),
    }
    if settings.motion_model.is_some() || settings.latent_model.is_some() {
        let tree = match known {
            Some(setup) => setup.tree(),
            None => bodies::find(&config.body)?,
        };
        settings.motion_model.iter().try_for_each(|model| check_model(model, &tree, settings.fps))?;
        settings.latent_model.iter().try_for_each(|model| check_latent_model(model, &tree, settings.fps))?;
    }
    world_up(&config, known).map(drop)
}
