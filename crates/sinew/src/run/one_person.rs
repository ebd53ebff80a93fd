//! A run of one person: from the beginning, or from where it was stopped.

use super::claimed::{claimed, claimed_in};
use super::former_results::refuse_people;
use super::listener::{Listener, watched};
use super::pieces::{calibration, how_to_resume, opened};
use super::refined_calibration;
use super::request::{CameTo, OneCameTo, Run};
use super::resume::{Start, stopped_run};
use super::threads::{wanted, with_threads};
use crate::Error;
use crate::config::Resolved;
use crate::input::roll::Roll;
use crate::input::source::FrameSource;
use crate::track::job::{self, Outcome, Watch};
use sinew_results::people::forget_people;
use sinew_results::{Claim, ResultFolder, problem, refuse_inputs};
use std::ops::Range;
use std::path::PathBuf;

/// A run into the folder of the settings, with what is said of it and made besides.
pub(crate) fn track<S: FrameSource + Send>(
    run: Run<'_>,
    source: &mut S,
    setup_frames: Range<u64>,
    claim: Option<Claim>,
) -> Result<CameTo, Error> {
    let Run { resolved, request, read_from, listener, .. } = run;
    let config = resolved.track();
    if !request.resume {
        refuse_people(&config, read_from, |_| Ok(()))?;
    }
    let start = match claim {
        Some(claim) => Start::New(claim),
        None if request.resume => stopped_run(&config, read_from, listener)?,
        None => Start::New(claimed_in(request.storage(), &config, read_from, listener)?),
    };
    let came_to = watched(listener, |watch| tracked(source, setup_frames, resolved, start, wanted(&config), watch));
    let came_to = came_to.inspect_err(|error| {
        if let Error::Results(sinew_results::Error::Checkpoint { .. }) = error {
            return;
        }
        // What is odd about the input may be why it could not be tracked.
        listener.warnings(&source.warnings());
        if config.out.join(problem::NAME).exists() {
            listener.note(&format!("the frames before are kept in {}; {}", config.out.display(), how_to_resume()));
        }
    })?;
    if let Some(path) = &request.write_calibration {
        refined_calibration::write(path, &config, run.calibration, listener)?;
    }
    if let OneCameTo::Tracked(outcome) = &came_to
        && outcome.summary.complete
    {
        forget_people(&config.out, 0)?;
    }
    Ok(came_to.into())
}

/// One run into its own folder, without anything besides; of one of several people, if they are named.
///
/// # Errors
/// [`Error`], as [`super::track`].
pub fn track_alone(
    resolved: &Resolved,
    chosen: Option<(&Roll, usize)>,
    read_from: &[PathBuf],
    listener: &dyn Listener,
) -> Result<Outcome, Error> {
    let config = resolved.track();
    refuse_inputs(&config.out, read_from)?;
    job::check_settings(resolved)?;
    let (mut recording, frames) = opened(&config, &calibration(&config)?, chosen)?;
    let claim = claimed(&config, read_from, listener)?;
    watched(listener, |watch| {
        with_threads(wanted(&config), || job::track(&mut recording, frames, resolved, claim, watch, None))
    })
}

/// The run itself on that many threads, or where it is complete, a check that it is the same.
pub(crate) fn tracked<S: FrameSource + Send>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    start: Start,
    threads: usize,
    watch: &mut Watch<'_>,
) -> Result<OneCameTo, Error> {
    let (claim, from) = match start {
        Start::New(claim) => (claim, None),
        Start::At(claim, checkpoint) => (claim, Some(*checkpoint)),
        Start::Complete(claim, summary) => {
            job::check_complete(source, setup_frames, resolved, claim.folder(), &summary, watch)?;
            ResultFolder::forget(&claim)?;
            return Ok(OneCameTo::Complete(summary));
        }
    };
    let run = || job::track(source, setup_frames, resolved, claim, watch, from);
    Ok(OneCameTo::Tracked(Box::new(with_threads(threads, run)?)))
}
