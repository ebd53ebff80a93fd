//! `sinew track --live`: frames in, a line of JSON out for each, and a note of what it came to.

use super::args::{General, TrackArgs};
use super::ended::{Ended, doubts};
use super::error::Error;
use super::report::Report;
use super::table::table;
use super::terminal::Terminal;
use sinew::config::Resolved;
use sinew::run::live::{LiveRequest, Streams, track};

/// Runs the command. Standard output has the answers alone, so the table goes to standard error.
pub(crate) fn run(
    from: &str,
    args: &TrackArgs,
    resolved: &Resolved,
    general: &General,
    report: &Report,
) -> Result<Ended, Error> {
    let setup_s = args.setup_seconds;
    if let Some(value) = setup_s.filter(|seconds| !(*seconds > 0.0 && *seconds <= MOST_SETUP_S)) {
        return Err(Error::NotPositive { flag: "setup-seconds", value, help: "a few seconds, at most 600" });
    }
    let request = LiveRequest {
        place: from.parse()?,
        standard: Streams { frames: Box::new(std::io::stdin()), answers: Box::new(std::io::stdout()) },
        setup_s,
        skips: args.skip,
        settings_file: general.config.clone(),
    };
    let outcome = track(resolved, request, &Terminal { general, report })?;
    report.warnings(&outcome.summary.warnings);
    report.note(table(&outcome, &resolved.track().out).trim_end());
    Ok(doubts(&outcome.summary.failed_diagnostics, report))
}

/// Seconds of frames that are kept for a set-up at most.
const MOST_SETUP_S: f64 = 600.0;
