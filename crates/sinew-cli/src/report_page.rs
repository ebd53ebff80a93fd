//! `sinew report`: one HTML page that shows a result, also written by `track --report` and `demo`.

use super::args::{General, ReportArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::terminal::Terminal;
use serde_json::json;
use sinew::results::RESULT_NAMES;
use sinew::results::error::ResultsError;
use sinew::results::people::{is_of_several, person_folder, refuse_several};
use sinew_runs::page::{PAGE, opening, refuse_others, write};
use sinew_tools::report::{ReportPage, ReportRequest};
use std::path::{Path, PathBuf};

/// Runs the command.
pub(crate) fn run(args: &ReportArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if is_of_several(&args.results) {
        return one_each(args, general, report);
    }
    let out = general.out.as_ref().map_or_else(|| args.results.join(PAGE), PathBuf::from);
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_results = folder.canonicalize().is_ok_and(|folder| args.results.canonicalize().is_ok_and(|it| it == folder));
    if in_results && RESULT_NAMES.iter().any(|name| out.ends_with(name)) {
        return Err(sinew_runs::Error::ResultIsOutput(out).into());
    }
    refuse_others(&out, general.force)?;
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
