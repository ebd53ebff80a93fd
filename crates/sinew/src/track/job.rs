//! A whole run: set-up, tracking, smoothing, result folder; what `sinew track` and `sinew demo` have in common.
//!
//! ```text
//! frames ──▶ set-up ──▶ setup.toml          (or a set-up of an earlier run)
//!    └─────▶ tracker ──▶ result folder      (through a spool on disk and a backward pass with `smooth`)
//! ```
//!
//! An interrupt ends the run after the frame at hand; what was done is written and marked incomplete. A checkpoint ([`crate::track::checkpoint`]) is written before the first frame, at a fixed interval of time and at an interrupt; from it a run resumes
//! to the same bytes, whatever stopped it: the set-up is that of the checkpoint, and what was read of the source is read again, which shows whether it is the same and counts what is odd about it.

mod backward;
mod begin;
mod check;
mod colours;
mod complete;
mod ending;
mod forward;
mod inputs;
mod keeper;
mod level;
pub mod live;
mod run_info;
mod watch;

pub use begin::read_setup;
pub use check::check_settings;
pub use complete::check_complete;
pub use ending::Outcome;
pub use watch::{RunPhase, Watch};

use super::checkpoint::Checkpoint;
use super::pipeline::Pipeline;
use crate::Error;
use crate::config::Resolved;
use crate::input::source::FrameSource;
use crate::setup::shared_cameras::CameraInformation;
use backward::smoothed;
use begin::{Begun, begun, resumed};
use colours::compared_colours;
use ending::{Clock, Finish};
use forward::forward;
use inputs::{file_hashes, hashes};
use keeper::Keeper;
use run_info::run_info;
use sinew_results::{Claim, ResultFolder};
use std::ops::Range;

/// A set-up that was made alone.
#[derive(Clone, Debug, PartialEq)]
pub struct MadeSetup {
    /// As `setup.toml` has it.
    pub toml: String,
    /// What the source says of its cameras; none where a set-up was given.
    pub said_of_cameras: Option<CameraInformation>,
    /// What is odd.
    pub warnings: Vec<String>,
}

/// The set-up of a source alone.
///
/// # Errors
/// Errors of the source and the set-up; an interrupt.
pub fn set_up<S: FrameSource>(source: &mut S, resolved: &Resolved, watch: &mut Watch<'_>) -> Result<MadeSetup, Error> {
    let config = resolved.track();
    let (settings, frames) = (resolved.settings()?, source.frames());
    let Begun { checkpoint, said_of_cameras, .. } = begun(source, frames, resolved, &config, &settings, watch)?;
    Ok(MadeSetup { toml: checkpoint.setup_toml, said_of_cameras, warnings: checkpoint.warnings })
}

/// Tracks the frames of a source into a claimed folder, from the first on or from where a run was stopped.
///
/// # Errors
/// Errors of the source, the set-up, the tracker and the disk; [`sinew_results::Error::Checkpoint`] where the run that was stopped is another one.
pub fn track<S: FrameSource>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    watch: &mut Watch<'_>,
    from: Option<Checkpoint>,
) -> Result<Outcome, Error> {
    let mut clock = Clock::started();
    let config = resolved.track();
    let settings = resolved.settings()?;
    let of_settings = file_hashes(resolved)?;
    let folder = claim.folder().to_owned();
    if from.is_none() {
        ResultFolder::refuse_others(&claim)?;
    }
    let Begun { mut source, setup, checkpoint, .. } = match from {
        Some(from) => resumed(source, from, resolved, &settings, &of_settings, &folder, watch)?,
        None => begun(source, setup_frames, resolved, &config, &settings, watch)?,
    };
    clock.set_up_is_done();

    let (tree, cameras, image_cameras) = (setup.tree(), source.cameras().to_vec(), source.image_cameras());
    let mut pipeline =
        Pipeline::with_images(&setup, &tree, &cameras, source.layout(), settings.clone(), image_cameras.as_deref())?;
    match &checkpoint.pipeline {
        Some(state) => pipeline.restore(state).map_err(|problem| sinew_results::Error::checkpoint(&folder, problem))?,
        None => ResultFolder::begin(&claim)?,
    }
    let (frames, before) = (source.frames(), checkpoint.done);
    let setup_toml = checkpoint.setup_toml.clone();
    let info = run_info(&config, &settings, &setup, &pipeline, cameras, frames.start, setup_toml);
    let mut keeper = Keeper::open(claim, info, checkpoint, &config, &pipeline)?;
    if keeper.checkpoint.pipeline.is_none() {
        keeper.keep(&pipeline, source.read(), hashes(&source, &of_settings))?;
    }
    let total = frames.end - frames.start;
    let tracked = forward(&mut keeper, &mut pipeline, &mut source, &of_settings, watch)?;
    keeper.take_rest(|_| ())?;
    clock.tracking_is_done();
    let Keeper { mut results, spool, checkpoint, .. } = keeper;
    let mut written = checkpoint.done;
    if let Some(mut spool) = spool {
        written = smoothed(&mut spool, &mut results, &pipeline, &tree, watch, written)?;
    }
    let done = checkpoint.done - before;
    let complete = written == total && tracked.is_ok();
    let finish = Finish { complete, skipped: 0, warnings: checkpoint.warnings, before, done };
    let summary = finish.summary(results, &pipeline, &of_settings, &source, &config, &clock)?;
    tracked?;
    let colours = compared_colours(&setup, &source, &settings);
    Ok(Outcome { summary, ms_per_frame: clock.ms_per_frame(done), body: tree, girth: setup.girth, colours })
}
