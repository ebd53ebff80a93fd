//! The output folder of a command, with a note on what was found in it.

use super::listener::Listener;
use crate::Error;
use crate::config::TrackConfig;
use sinew_results::{Claim, Disk, Storage, claim_in};
use std::path::PathBuf;
use std::sync::Arc;

/// The output folder, for this process alone.
///
/// # Errors
/// The folder is in use, holds results or cannot be made.
pub fn claimed(config: &TrackConfig, inputs: &[PathBuf], listener: &dyn Listener) -> Result<Claim, Error> {
    claimed_in(Arc::new(Disk), config, inputs, listener)
}

/// As [`claimed`], with files kept in the given storage.
///
/// # Errors
/// As [`claimed`].
pub fn claimed_in(
    storage: Arc<dyn Storage>,
    config: &TrackConfig,
    inputs: &[PathBuf],
    listener: &dyn Listener,
) -> Result<Claim, Error> {
    let claim = claim_in(storage, &config.out, inputs, config.force)?;
    listener.warnings(stale(&claim).as_slice());
    Ok(claim)
}

/// That a run before left its lock, if one did.
pub(crate) fn stale(claim: &Claim) -> Option<String> {
    let pid = claim.stale_lock_of?;
    let folder = claim.folder().display();
    Some(format!("process {pid} left its lock in {folder}; it is gone, the lock is taken over"))
}
