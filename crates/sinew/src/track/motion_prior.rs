//! The motion prior of a recording: a random walk with the noise that the set-up found.

use super::error::TrackError;
use crate::Error;
use crate::config::settings::Settings;
use crate::setup::{Setup, motion_noise};
use sinew_body::KinematicTree;
use sinew_dynamics::random_walk::RandomWalk;

/// The motion prior of a recording.
pub fn walk(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Result<RandomWalk, Error> {
    let sd = match &setup.motion_sd {
        Some(sd) if sd.len() == tree.dof() => sd.clone(),
        _ => motion_noise::default_sd(tree),
    };
    let sd: Vec<f64> = sd.iter().map(|sd| sd * settings.motion_scale).collect();
    let walk = RandomWalk::new(&sd, 1.0 / settings.fps, settings.between, settings.isa);
    Ok(walk.and_then(|walk| walk.with_initial_sd(motion_noise::initial_sd(tree))).map_err(TrackError::Motion)?)
}
