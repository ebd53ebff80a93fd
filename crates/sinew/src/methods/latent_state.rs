//! What methods in a latent space share: the state [λ, θ, ρ] and how it moves.
//!
//! λ are the leading coordinates of the body's state, and ρ the last ones, which the model does not hold, such as the angles of feet; often there are none. θ is the latent of the pose between.
//!
//! λ and ρ walk at random with the noise that the set-up measured. θ moves by the model's dynamics, or walks, with half of the largest step of the latents that the model was learned from.

use super::about::{About, Making};
use crate::Error;
use crate::track::error::TrackError;
use sinew_core::beside::Beside;
use sinew_core::side_by_side::SideBySide;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_latent::file::StoredModel;
use sinew_latent::motion::{LatentMotion, StepNoise, step_sd};
use sinew_latent::space::Below;
use std::ops::Range;

/// Place of the root among the nodes of a model.
pub const ROOT: usize = 0;

/// The latent model of a run.
///
/// # Errors
/// [`TrackError::NoLatentModel`].
pub fn stored<'a>(making: &Making<'a>, method: &About) -> Result<&'a StoredModel, Error> {
    Ok(making.latent.ok_or(TrackError::NoLatentModel { method: method.name })?)
}

/// From [λ, θ, ρ] to the body's state.
///
/// # Errors
/// A model whose maps cannot be made.
pub fn decoder(making: &Making<'_>, stored: &StoredModel) -> Result<Beside<Below>, Error> {
    let StoredModel { free, ref model, .. } = *stored;
    let below = Below::new(model, ROOT, making.isa).map_err(TrackError::Latent)?;
    let held: Vec<usize> = (0..model.columns).collect();
    let pose = making.transition.sd().len() - free;
    Ok(Beside::new(free, below, &held, pose).map_err(sinew_tracking::Error::Core)?)
}

/// Coordinates of the body's state that are λ.
#[must_use]
pub const fn leading(stored: &StoredModel) -> Range<usize> {
    0..stored.free
}

/// Coordinates of the body's state that are ρ.
#[must_use]
pub fn rest(making: &Making<'_>, stored: &StoredModel) -> Range<usize> {
    stored.free + stored.model.columns..making.transition.sd().len()
}

/// A vector for [λ, θ, ρ]: for λ and ρ from a vector for the body's state, with the values for θ between.
#[must_use]
pub fn around(making: &Making<'_>, stored: &StoredModel, state: &[f64], latent: &[f64]) -> Vec<f64> {
    [&state[leading(stored)], latent, &state[rest(making, stored)]].concat()
}

/// Motion of [λ, θ, ρ].
pub type LatentWalk = SideBySide<SideBySide<RandomWalk, LatentMotion>, Option<RandomWalk>>;

/// The motion of [λ, θ, ρ] of the root.
///
/// # Errors
/// A model without dynamics, and a walk that the noise does not allow.
pub fn motion(making: &Making<'_>, stored: &StoredModel) -> Result<LatentWalk, Error> {
    let walk = |own: Range<usize>| -> Result<RandomWalk, Error> {
        let first = making.transition.initial_sd()[own.clone()].to_vec();
        let walk = RandomWalk::new(&making.transition.sd()[own], 1.0, Between::Gaussian, making.isa)
            .and_then(|walk| walk.with_initial_sd(first));
        Ok(walk.map_err(TrackError::Motion)?)
    };
    let noise = StepNoise::Fixed(step_sd(&stored.model, ROOT));
    let motion = LatentMotion::new(&stored.model, ROOT, noise, making.isa).map_err(TrackError::Latent)?;
    let rest = rest(making, stored);
    let rest = (!rest.is_empty()).then(|| walk(rest)).transpose()?;
    Ok(SideBySide(SideBySide(walk(leading(stored))?, motion), rest))
}

/// The random walk of [λ, θ, ρ] of the root.
///
/// # Errors
/// A walk that the noise does not allow.
pub fn walk(making: &Making<'_>, stored: &StoredModel, between: Between) -> Result<RandomWalk, Error> {
    let latent = step_sd(&stored.model, ROOT);
    let sd = around(making, stored, making.transition.sd(), &latent);
    let first = around(making, stored, making.transition.initial_sd(), &latent);
    let walk = RandomWalk::new(&sd, 1.0, between, making.isa).and_then(|walk| walk.with_initial_sd(first));
    Ok(walk.map_err(TrackError::Motion)?)
}
