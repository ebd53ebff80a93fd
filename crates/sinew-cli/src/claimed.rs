//! The output folder of a command, with a note on what was found in it.

use super::error::Error;
use super::report::Report;
use sinew::config::TrackConfig;
use sinew::results::{Claim, claim};
use std::path::PathBuf;

/// The output folder, for this process alone.
pub(crate) fn claimed(config: &TrackConfig, inputs: &[PathBuf], report: &Report) -> Result<Claim, Error> {
    let claim = claim(&config.out, inputs, config.force)?;
    report.warnings(stale(&claim).as_slice());
    Ok(claim)
}

/// That a run before left its lock, if one did.
pub(crate) fn stale(claim: &Claim) -> Option<String> {
    let pid = claim.stale_lock_of?;
    let folder = claim.folder().display();
    Some(format!("process {pid} left its lock in {folder}; it is gone, the lock is taken over"))
}
