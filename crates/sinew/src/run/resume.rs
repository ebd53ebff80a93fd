//! What `--resume` finds in the output folder: a run to continue, or complete results.

use super::claimed::stale;
use super::listener::Listener;
use crate::Error;
use crate::config::TrackConfig;
use crate::track::checkpoint::{self, Checkpoint};
use sinew_results::people::is_of_several;
use sinew_results::problem::{self, Problem};
use sinew_results::{Claim, RESULT_NAMES, claim_to_resume, is_incomplete};
use std::path::{Path, PathBuf};

/// Where a run begins.
pub(crate) enum Start {
    /// At its first frame.
    New(Claim),
    /// Where it was stopped.
    At(Claim, Box<Checkpoint>),
    /// At its end, with its summary.
    Complete(Claim, serde_json::Value),
}

/// Whether a run was stopped in a folder, of one person or of several, that can be resumed.
pub fn is_stopped(folder: &Path) -> bool {
    folder.join(problem::NAME).exists() || (is_of_several(folder) && is_incomplete(folder))
}

/// The run to continue, in its folder, for this process alone.
pub(crate) fn stopped_run(config: &TrackConfig, inputs: &[PathBuf], listener: &dyn Listener) -> Result<Start, Error> {
    let claim = claim_to_resume(&config.out, inputs)?;
    if let Some(stale) = stale(&claim) {
        // A run that is resumed was stopped: no wonder.
        listener.note(&stale);
    }
    let path = config.out.join("summary.json");
    let summary: Option<serde_json::Value> =
        std::fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
    let is_unfinished = RESULT_NAMES.iter().any(|name| config.out.join(format!("{name}.partial")).exists());
    if let Some(summary) = summary.filter(|summary| summary["complete"] == true && !is_unfinished) {
        return Ok(Start::Complete(claim, summary));
    }
    if !claim.is_resumable && (claim.stale_lock_of.is_some() || is_unfinished) {
        return Err(sinew_results::Error::checkpoint(&config.out, Problem::BeforeFirst).into());
    }
    Ok(Start::At(claim, Box::new(checkpoint::read(&config.out)?)))
}

/// The run of one of several people to continue; `None` where it was stopped before its first frame or never begun.
pub(crate) fn stopped_or_begun(
    config: &TrackConfig,
    inputs: &[PathBuf],
    listener: &dyn Listener,
) -> Result<Option<Start>, Error> {
    match stopped_run(config, inputs, listener) {
        Ok(stopped) => Ok(Some(stopped)),
        Err(Error::Results(sinew_results::Error::Checkpoint { problem, .. })) if problem.is_before_first() => Ok(None),
        Err(error) => Err(error),
    }
}

/// Refuses the folder of several people where one is to be tracked, and the other way round.
pub(crate) fn refuse_other_number(out: &Path, tracks_several: bool) -> Result<(), Error> {
    const WHO: [&str; 2] = ["one person", "several people"];
    let is_there = is_of_several(out);
    let is_of_one = [problem::NAME, "joints.csv", "joints.csv.partial"].iter().any(|name| out.join(name).exists());
    if tracks_several == is_there || !(is_there || is_of_one) {
        return Ok(());
    }
    let [found, expected] = [is_there, tracks_several].map(|several| WHO[usize::from(several)]);
    Err(sinew_results::Error::checkpoint(out, Problem::Whom { found, expected }).into())
}
