//! Why a folder has no summary: it holds no results, its run was stopped, or its run is still going.

use crate::{Error, RESULT_NAMES, ReadError, is_in_use};
use std::path::Path;

/// Why a folder has no summary.
#[must_use]
pub fn without_summary(folder: &Path) -> Error {
    if let Err(error) = std::fs::read_dir(folder) {
        return Error::io("read", folder)(error);
    }
    let is_partial = |name: &&str| folder.join(format!("{name}.partial")).exists();
    let folder = folder.to_owned();
    if is_in_use(&folder) {
        ReadError::Running(folder).into()
    } else if RESULT_NAMES.iter().any(is_partial) {
        ReadError::Stopped(folder).into()
    } else {
        ReadError::NoSummary(folder).into()
    }
}
