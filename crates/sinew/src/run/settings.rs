//! Settings of a run from what was given by name, the environment and files.

use super::listener::Listener;
use crate::Error;
use crate::config::{Resolved, Sources, TrackConfig, resolve};
use crate::input::flag::flag;
use crate::input::recording::RecordingOptions;
use crate::input::recording::keypoint_sources::stated_rate;
use std::path::{Path, PathBuf};

/// Settings by name, as they are typed.
pub type Given = Vec<(&'static str, String)>;

/// Settings from all their sources: given by name, then `SINEW_…` of the environment, then files.
///
/// # Errors
/// Every mistake in them.
pub fn settings(given: &[(&'static str, String)], file: Option<&Path>) -> Result<Resolved, Error> {
    let environment =
        std::env::vars_os().filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
    let mut environment: Vec<(String, String)> = environment.filter(|(name, _)| name.starts_with("SINEW_")).collect();
    environment.sort();
    resolve(&Sources { flags: given.to_vec(), environment, file: file.map(PathBuf::from) })
}

/// Settings with the frame rate that the times in the keypoints say, as though it had been given, where nothing else gives one.
///
/// # Errors
/// As [`settings`].
pub fn settings_with_stated_rate(
    given: &[(&'static str, String)],
    file: Option<&Path>,
    listener: &dyn Listener,
) -> Result<(Given, Resolved), Error> {
    let mut given = given.to_vec();
    let resolved = settings(&given, file)?;
    let config = resolved.track();
    let (None, Some(keypoints)) = (config.fps, &config.keypoints) else { return Ok((given, resolved)) };
    // What cannot be read is reported where the recording is opened.
    let Ok(Some(rate)) = stated_rate(keypoints) else { return Ok((given, resolved)) };
    listener.note(&format!("{rate} frames per second, by the times in {} ({})", keypoints.display(), flag("fps")));
    given.push(("fps", rate.to_string()));
    let resolved = settings(&given, file)?;
    Ok((given, resolved))
}

/// What to take from a recording.
#[must_use]
pub fn reading(config: &TrackConfig) -> RecordingOptions {
    RecordingOptions {
        layout: config.layout.clone(),
        confidence_scale: config.confidence_scale,
        image_scale: config.image_scale,
        frames: config.frames.clone(),
        cameras: config.cameras.clone(),
        trim: config.trim,
        lag: config.lag.clone(),
        read_before: std::sync::Arc::clone(&config.read_before),
    }
}
