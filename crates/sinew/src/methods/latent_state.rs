//! What methods in a latent space share: the state [λ, θ] and how it moves.
//!
//! λ are the leading coordinates of the body's state, which no model holds, θ is the latent of its pose.
//!
//! λ walks at random with the noise that the set-up measured. θ moves by the model's dynamics, or walks, with half of the largest step of the latents that the model was learned from.

use super::about::{About, Making};
use crate::Error;
use crate::track::error::TrackError;
use sinew_core::side_by_side::SideBySide;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_latent::file::StoredModel;
use sinew_latent::motion::{LatentMotion, StepNoise, step_sd};

/// Place of the root among the nodes of a model.
pub const ROOT: usize = 0;

/// The latent model of a run.
///
/// # Errors
/// [`TrackError::NoLatentModel`].
pub fn stored<'a>(making: &Making<'a>, method: &About) -> Result<&'a StoredModel, Error> {
    Ok(making.latent.ok_or(TrackError::NoLatentModel { method: method.name })?)
}

/// Standard deviations of a step of λ.
#[must_use]
pub fn free_sd<'a>(making: &Making<'a>, stored: &StoredModel) -> &'a [f64] {
    &making.transition.sd()[..stored.free]
}

/// The motion of [λ, θ] of the root.
///
/// # Errors
/// A model without dynamics, and a walk that the noise does not allow.
pub fn motion(making: &Making<'_>, stored: &StoredModel) -> Result<SideBySide<RandomWalk, LatentMotion>, Error> {
    let first = making.transition.initial_sd()[..stored.free].to_vec();
    let walk = RandomWalk::new(free_sd(making, stored), 1.0, Between::Gaussian, making.isa)
        .and_then(|walk| walk.with_initial_sd(first))
        .map_err(TrackError::Motion)?;
    let noise = StepNoise::Fixed(step_sd(&stored.model, ROOT));
    let motion = LatentMotion::new(&stored.model, ROOT, noise, making.isa).map_err(TrackError::Latent)?;
    Ok(SideBySide(walk, motion))
}

/// The random walk of [λ, θ] of the root.
///
/// # Errors
/// A walk that the noise does not allow.
pub fn walk(making: &Making<'_>, stored: &StoredModel, between: Between) -> Result<RandomWalk, Error> {
    let latent = step_sd(&stored.model, ROOT);
    let sd = [free_sd(making, stored), &latent[..]].concat();
    let first = [&making.transition.initial_sd()[..stored.free], &latent[..]].concat();
    let walk = RandomWalk::new(&sd, 1.0, between, making.isa).and_then(|walk| walk.with_initial_sd(first));
    Ok(walk.map_err(TrackError::Motion)?)
}
