//! Files that other commands make of results and keep beside them: the page, the gait, the comparison.

use crate::{Error, Occupied};
use std::io::Read as _;
use std::path::Path;

/// Name of the page in a result folder.
pub const PAGE_NAME: &str = "report.html";

/// How the title of every page ends, and where it stands at the latest.
pub const PAGE_TITLE_END: &str = " · sinew report</title>";
const HEAD_BYTES: u64 = 4096;

/// Files of `sinew gait`, in the order in which they are written.
pub const GAIT_NAMES: [&str; 4] = ["gait_events.csv", "gait_parameters.csv", "gait_cycles.csv", "gait.svg"];
/// Files of `sinew compare`, in the order in which they are written.
pub const COMPARISON_NAMES: [&str; 3] = ["comparison.csv", "comparison.json", "bland_altman.svg"];
/// Table of the draws of angles that a study keeps of each of its trials.
pub const ANGLE_DRAWS_NAME: &str = "angle_draws.csv";

/// Refuses to write over what is no page of a result, without `force`. A former page is no loss.
///
/// # Errors
/// [`Error::OutputExists`].
pub fn refuse_other_page(out: &Path, force: bool) -> Result<(), Error> {
    let is_in_the_way = out.exists() && !force && !is_page(out);
    let refused = || Error::OutputExists { path: out.to_owned(), found: Occupied::File };
    if is_in_the_way { Err(refused()) } else { Ok(()) }
}

/// Whether a file is a page of results, by its title.
pub fn is_page(path: &Path) -> bool {
    let mut head = vec![];
    let read = std::fs::File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(PAGE_TITLE_END)
}

/// Whether a file of a result folder is made of the results: where they are replaced, it is no longer true.
pub(crate) fn is_derived(name: &str) -> bool {
    [PAGE_NAME, ANGLE_DRAWS_NAME].contains(&name) || GAIT_NAMES.contains(&name) || COMPARISON_NAMES.contains(&name)
}
