//! Whether a run was stopped in a folder.

use super::claim::is_incomplete;
use super::people::is_of_several;
use super::problem;
use std::path::Path;

/// Whether a run was stopped in a folder, of one person or of several, that can be resumed.
#[must_use]
pub fn is_stopped(folder: &Path) -> bool {
    folder.join(problem::NAME).exists() || (is_of_several(folder) && is_incomplete(folder))
}
