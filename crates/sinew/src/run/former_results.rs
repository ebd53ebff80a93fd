//! Results of people of runs before, in the folder of a run.

use crate::Error;
use crate::config::TrackConfig;
use sinew_results::people::person_folders;
use sinew_results::{Claim, claim};
use std::path::PathBuf;

/// Refuses results and stopped runs of people that are not to be replaced, and those that `check` refuses.
pub(crate) fn refuse_people(
    config: &TrackConfig,
    read_from: &[PathBuf],
    check: impl Fn(&Claim) -> Result<(), sinew_results::Error>,
) -> Result<(), Error> {
    for folder in person_folders(&config.out) {
        check(&claim(&folder, read_from, config.force)?)?;
    }
    Ok(())
}
