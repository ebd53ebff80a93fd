//! What a run removes of runs before in its folder: results of one person where several come, and the other way round.

use crate::Error;
use crate::config::TrackConfig;
use sinew_results::{OWN_NAMES, RESULT_NAMES, claim, forget_derived, remove};
use std::path::{Path, PathBuf};

/// Removes the results of people of a run before; refuses results and stopped runs that are not to be replaced.
pub(crate) fn forget_people(config: &TrackConfig, read_from: &[PathBuf]) -> Result<(), Error> {
    let folder = config.out.join("people");
    if !folder.is_dir() {
        return Ok(());
    }
    let failed = |error| Error::io("read", &folder)(error);
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        drop(claim(&entry.map_err(failed)?.path(), read_from, config.force)?);
    }
    std::fs::remove_dir_all(&folder).map_err(Error::io("remove", &folder))?;
    Ok(remove(&config.out.join("people.csv"))?)
}

/// Removes the results of a run of one person, in whose place results of several come.
pub(crate) fn forget_one(out: &Path) -> Result<(), Error> {
    RESULT_NAMES.iter().chain(&OWN_NAMES).try_for_each(|name| remove(&out.join(name)))?;
    Ok(forget_derived(out)?)
}
