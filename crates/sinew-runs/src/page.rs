//! The page of a result folder, and what else was made of results that are replaced.

use super::error::Error;
use super::listener::Listener;
use sinew::results::error::Occupied;
use sinew::results::write_whole;
use sinew_tools::gait::GAIT_NAMES;
use sinew_tools::report::COMPARISON_NAMES;
use sinew_tools::report::{ReportPage, ReportRequest, page};
use std::io::Read as _;
use std::path::Path;

/// Name of the page in a result folder.
pub const PAGE: &str = "report.html";

/// How the title of every page ends, and where it stands at the latest.
const TITLE_END: &str = " · sinew report</title>";
const HEAD_BYTES: u64 = 4096;

/// Writes the page of a result folder.
///
/// # Errors
/// [`Error::Tools`] for results that no page can be made of, [`Error::Library`] for the disk.
pub fn write(
    results: &Path,
    request: &ReportRequest,
    out: &Path,
    listener: &dyn Listener,
) -> Result<ReportPage, Error> {
    let written = page(results, request)?;
    write_whole(out, written.html.as_bytes())?;
    if written.every > 1 {
        listener.note(&format!("the page shows one frame in {}; all would make it too large", written.every));
    }
    Ok(written)
}

/// Refuses to write over what is no page of a result, without `force`. A former page is no loss.
///
/// # Errors
/// [`sinew::Error::OutputExists`].
pub fn refuse_others(out: &Path, force: bool) -> Result<(), sinew::Error> {
    let is_in_the_way = out.exists() && !force && !is_page(out);
    let refused = || sinew::Error::OutputExists { path: out.to_owned(), found: Occupied::File };
    if is_in_the_way { Err(refused()) } else { Ok(()) }
}

/// Whether a file is a page of results, by its title.
fn is_page(path: &Path) -> bool {
    let mut head = vec![];
    let read = std::fs::File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(TITLE_END)
}

/// Removes the page, the gait and the comparison of results that were replaced.
pub(crate) fn forget_derived(results: &Path) -> Result<(), sinew::Error> {
    let page = results.join(PAGE);
    if is_page(&page) {
        remove(&page)?;
    }
    GAIT_NAMES.iter().chain(&COMPARISON_NAMES).try_for_each(|name| remove(&results.join(name)))
}

/// Removes a file or a folder, if it is there.
pub(crate) fn remove(path: &Path) -> Result<(), sinew::Error> {
    let done = if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    match done {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(sinew::Error::io("remove", path)(error)),
        _ => Ok(()),
    }
}

/// What a page is made from where a calibration is all that is known besides.
#[must_use]
pub fn with_calibration(calibration: &Path) -> ReportRequest {
    let file = Some(calibration.to_owned()).filter(|file| !file.as_os_str().is_empty());
    ReportRequest { calibration: file, ..ReportRequest::default() }
}

/// The line that opens a page in a browser.
#[must_use]
pub fn opening(page: &Path) -> String {
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "start"
    } else {
        "xdg-open"
    };
    let shown = page.display().to_string();
    if shown.contains(char::is_whitespace) { format!("{opener} \"{shown}\"") } else { format!("{opener} {shown}") }
}
