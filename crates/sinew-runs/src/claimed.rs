//! The output folder of a command, with a note on what was found in it.

use super::error::Error;
use super::listener::Listener;
use sinew::config::TrackConfig;
use sinew::results::{Claim, claim};
use std::path::PathBuf;

/// The output folder, for this process alone.
///
/// # Errors
/// [`Error::Library`] where it is in use, holds results or cannot be made.
pub fn claimed(config: &TrackConfig, inputs: &[PathBuf], listener: &dyn Listener) -> Result<Claim, Error> {
    let claim = claim(&config.out, inputs, config.force)?;
    listener.warnings(stale(&claim).as_slice());
    Ok(claim)
}

/// That a run before left its lock, if one did.
pub(crate) fn stale(claim: &Claim) -> Option<String> {
    let pid = claim.stale_lock_of?;
    let folder = claim.folder().display();
    Some(format!("process {pid} left its lock in {folder}; it is gone, the lock is taken over"))
}
