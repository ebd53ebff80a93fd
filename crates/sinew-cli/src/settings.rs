//! Settings of a command from flags, environment and files.

use super::args::General;
use super::error::Error;
use sinew::config::{Resolved, Sources, TrackConfig, resolve};
use sinew::input::recording::RecordingOptions;

/// Settings from all their sources.
pub(crate) fn settings(flags: &[(&'static str, String)], general: &General) -> Result<Resolved, Error> {
    let flags = [flags, &general.settings()].concat();
    let environment =
        std::env::vars_os().filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)));
    let mut environment: Vec<(String, String)> = environment.filter(|(name, _)| name.starts_with("SINEW_")).collect();
    environment.sort();
    Ok(resolve(&Sources { flags, environment, file: general.config.clone() })?)
}

/// What to take from a recording.
pub(crate) fn reading(config: &TrackConfig) -> RecordingOptions {
    RecordingOptions {
        layout: config.layout.clone(),
        confidence_scale: config.confidence_scale,
        image_scale: config.image_scale,
        frames: config.frames.clone(),
        cameras: config.cameras.clone(),
        trim: config.trim,
        lag: config.lag.clone(),
    }
}
