//! `sinew report`: one HTML page that shows a result, also written by `track --report` and `demo`.

use super::args::{General, ReportArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use serde_json::json;
use sinew::results::error::{Occupied, ResultsError};
use sinew::results::people::{is_of_several, person_folder, refuse_several};
use sinew::results::{RESULT_NAMES, write_whole};
use sinew_tools::report::{ReportPage, ReportRequest, page};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// Name of the page in a result folder.
pub(crate) const PAGE: &str = "report.html";

/// How the title of every page ends, and where it stands at the latest.
const TITLE_END: &str = " · sinew report</title>";
const HEAD_BYTES: u64 = 4096;

/// Runs the command.
pub(crate) fn run(args: &ReportArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if is_of_several(&args.results) {
        return one_each(args, general, report);
    }
    let out = general.out.as_ref().map_or_else(|| args.results.join(PAGE), PathBuf::from);
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_results = folder.canonicalize().is_ok_and(|folder| args.results.canonicalize().is_ok_and(|it| it == folder));
    if in_results && RESULT_NAMES.iter().any(|name| out.ends_with(name)) {
        return Err(Error::ResultIsOutput(out));
    }
    refuse_others(&out, general.force)?;
    let (calibration, validation) = (args.calibration.clone(), args.validation.clone());
    let request = ReportRequest { calibration, validation, ..ReportRequest::default() };
    let written = write(&args.results, &request, &out, report)?;
    if args.answer.json {
        let ReportPage { html, frames, every } = &written;
        report::answer_json(&json!({ "out": out, "bytes": html.len(), "frames": frames, "every": every }))?;
    } else {
        let megabytes = written.html.len() as f64 / 1e6;
        report::answer(&format!("{} ({megabytes:.1} MB)\nOpen it:\n  {}\n", out.display(), opening(&out)))?;
    }
    Ok(Ended::Done)
}

/// A page of each of several people, in the folder of his results.
fn one_each(args: &ReportArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if general.out.is_some() {
        // One file cannot hold the pages of all.
        refuse_several(&args.results).map_err(sinew::Error::from)?;
    }
    let folders = (0..).map(|index| args.results.join(person_folder(index))).take_while(|folder| folder.is_dir());
    let (mut pages, mut answers) = (vec![], vec![]);
    for folder in folders.filter(|folder| folder.join("summary.json").is_file()) {
        let out = folder.join(PAGE);
        let (calibration, validation) = (args.calibration.clone(), args.validation.clone());
        let request = ReportRequest { calibration, validation, ..ReportRequest::default() };
        let ReportPage { html, frames, every } = write(&folder, &request, &out, report)?;
        answers.push(json!({ "out": out, "bytes": html.len(), "frames": frames, "every": every }));
        pages.push(format!("{} ({:.1} MB)\n", out.display(), html.len() as f64 / 1e6));
    }
    if pages.is_empty() {
        return Err(sinew::Error::from(ResultsError::NoSummary(args.results.clone())).into());
    }
    if args.answer.json {
        report::answer_json(&answers.into())?;
    } else {
        report::answer(&format!("one page a person:\n{}", pages.concat()))?;
    }
    Ok(Ended::Done)
}

/// Writes the page of a result folder.
pub(crate) fn write(results: &Path, request: &ReportRequest, out: &Path, report: &Report) -> Result<ReportPage, Error> {
    let written = page(results, request)?;
    write_whole(out, written.html.as_bytes())?;
    if written.every > 1 {
        report.note(&format!("the page shows one frame in {}; all would make it too large", written.every));
    }
    Ok(written)
}

/// Refuses to write over what is no page of a result, without `--force`. A former page is no loss.
pub(crate) fn refuse_others(out: &Path, force: bool) -> Result<(), Error> {
    let is_in_the_way = out.exists() && !force && !is_page(out);
    let refused = || sinew::Error::OutputExists { path: out.to_owned(), found: Occupied::File };
    if is_in_the_way { Err(refused().into()) } else { Ok(()) }
}

/// Whether a file is a page that this command wrote, by its title.
fn is_page(path: &Path) -> bool {
    let mut head = vec![];
    let read = std::fs::File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(TITLE_END)
}

/// Removes the page of results that were replaced.
pub(crate) fn forget(results: &Path) -> Result<(), sinew::Error> {
    let page = results.join(PAGE);
    if !is_page(&page) {
        return Ok(());
    }
    match std::fs::remove_file(&page) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(sinew::Error::io("remove", page)(error)),
        _ => Ok(()),
    }
}

/// What a page is made from where a calibration is all that is known besides.
pub(crate) fn with_calibration(calibration: &Path) -> ReportRequest {
    ReportRequest { calibration: Some(calibration.to_owned()), ..ReportRequest::default() }
}

/// The line that opens a page in a browser.
pub(crate) fn opening(page: &Path) -> String {
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
