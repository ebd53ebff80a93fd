//! Settings of a run, and what its recording says of them.

use super::listener::Listener;
use crate::Error;
use crate::config::Resolved;
use crate::config::common::{FPS, KEYPOINTS};
use crate::input::flag::flag;
use crate::input::recording::keypoint_sources::stated_rate;

pub use crate::config::resolved::{Given, settings};

/// Settings with the frame rate that the times in the keypoints say, as though it had been given, where nothing else gives one.
///
/// # Errors
/// A rate that no recording has.
pub fn with_stated_rate(resolved: Resolved, listener: &dyn Listener) -> Result<Resolved, Error> {
    let (None, Some(keypoints)) = (resolved.of(&FPS), resolved.of(&KEYPOINTS)) else { return Ok(resolved) };
    // What cannot be read is reported where the recording is opened.
    let Ok(Some(rate)) = stated_rate(&keypoints) else { return Ok(resolved) };
    listener.note(&format!("{rate} frames per second, by the times in {} ({})", keypoints.display(), flag(FPS.key)));
    resolved.with_flag(&FPS, &rate.to_string())
}
