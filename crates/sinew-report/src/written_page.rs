//! The page of a result folder, written into it.

use crate::Error;
use crate::page::{ReportPage, ReportRequest, page};
use sinew::run::listener::Listener;
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_input::files::read_text;
use sinew_results::people::{is_of_several, person_folders};
use sinew_results::{PAGE_NAME, list_derived, write_whole};
use std::path::Path;

/// Writes the page of a result folder.
///
/// # Errors
/// Results that no page can be made of; the disk.
pub fn write(
    results: &Path,
    request: &ReportRequest,
    out: &Path,
    listener: &dyn Listener,
) -> Result<ReportPage, Error> {
    let written = page(results, request)?;
    write_whole(out, written.html.as_bytes())?;
    if *out == results.join(PAGE_NAME) {
        list_derived(results, &[PAGE_NAME])?;
    }
    if written.every > 1 {
        listener.note(&format!("the page shows one frame in {}; all would make it too large", written.every));
    }
    Ok(written)
}

/// Writes the page of a run into its folder, or one a person into theirs; none where no frame was tracked.
///
/// # Errors
/// As [`write()`].
pub fn write_for_run(out: &Path, calibration: &Path, listener: &dyn Listener) -> Result<(), Error> {
    let folders = if is_of_several(out) { person_folders(out).collect() } else { vec![out.to_owned()] };
    for folder in folders {
        let summary = folder.join("summary.json");
        if !summary.is_file() {
            continue;
        }
        let summary: serde_json::Value =
            json_text::parse(&summary.display().to_string(), &read_text(&summary, MAX_TEXT_BYTES)?)?;
        if summary["frame_count"].as_u64().unwrap_or_default() > 0 {
            let page = folder.join(PAGE_NAME);
            write(&folder, &with_calibration(calibration), &page, listener)?;
            listener.note(&format!("a page that shows the results: {}", opening(&page)));
        }
    }
    Ok(())
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
