//! `sinew report`: one HTML page that shows a result, also written by `track --report` and `demo`.

use super::args::{General, ReportArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::terminal::Terminal;
use serde_json::json;
use sinew_report::page::{ReportPage, ReportRequest};
use sinew_report::written_page::{opening, write};
use sinew_results::RESULT_NAMES;
use sinew_results::ResultsError;
use sinew_results::people::{is_of_several, person_folders, refuse_several};
use sinew_results::{PAGE_NAME, refuse_other_page};
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &ReportArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if is_of_several(&args.results) {
        return one_each(args, general, report);
    }
    let out = general.out.as_ref().map_or_else(|| args.results.join(PAGE_NAME), PathBuf::from);
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_results = folder.canonicalize().is_ok_and(|folder| args.results.canonicalize().is_ok_and(|it| it == folder));
    if in_results && RESULT_NAMES.iter().any(|name| out.ends_with(name)) {
        return Err(sinew::Error::ResultIsOutput(out).into());
    }
    let is_out = |input: &&PathBuf| out.canonicalize().is_ok_and(|out| input.canonicalize().is_ok_and(|it| it == out));
    if let Some(input) = args.calibration.iter().chain(&args.validation).find(is_out) {
        return Err(sinew::Error::InputIsOutput(input.clone()).into());
    }
    refuse_other_page(&out, general.force)?;
    let (calibration, validation) = (args.calibration.clone(), args.validation.clone());
    let request = ReportRequest { calibration, validation, ..ReportRequest::default() };
    let written = write(&args.results, &request, &out, &Terminal { general, report })?;
    if args.answer.json {
        let ReportPage { html, frames, every } = &written;
        report::answer_json(&json!({ "out": out, "bytes": html.len(), "frames": frames, "every": every }))?;
    } else {
        let megabytes = written.html.len() as f64 / 1e6;
        report::answer(&format!("{} ({megabytes:.1} MB)\nOpen it:\n  {}\n", out.display(), opening(&out)))?;
    }
    Ok(Ended::Done)
}

/// A page of each of several people, in the folder of their results.
fn one_each(args: &ReportArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if general.out.is_some() {
        // One file cannot hold the pages of all.
        refuse_several(&args.results).map_err(sinew::Error::from)?;
    }
    let (mut pages, mut answers) = (vec![], vec![]);
    for folder in person_folders(&args.results).filter(|folder| folder.join("summary.json").is_file()) {
        let out = folder.join(PAGE_NAME);
        refuse_other_page(&out, general.force)?;
        let (calibration, validation) = (args.calibration.clone(), args.validation.clone());
        let request = ReportRequest { calibration, validation, ..ReportRequest::default() };
        let ReportPage { html, frames, every } = write(&folder, &request, &out, &Terminal { general, report })?;
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
