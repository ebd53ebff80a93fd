//! The backward pass of a run: what its spool holds, smoothed and written.

use super::watch::{RunPhase, Watch};
use crate::Error;
use crate::input::flag::flag;
use crate::track::pipeline::Pipeline;
use crate::track::smooth::{Spool, smooth};
use sinew_body::KinematicTree;
use sinew_results::ResultFolder;
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;

/// Smooths what a spool holds; gives the number of frames written. A stop in the backward pass ends it; a stop before it smooths what there is.
pub(super) fn smoothed(
    spool: &mut Spool,
    results: &mut ResultFolder,
    pipeline: &Pipeline,
    tree: &KinematicTree,
    watch: &mut Watch<'_>,
    frames: u64,
) -> Result<u64, Error> {
    let (asked_before, stop) = (watch.is_stopped(), watch.stop);
    let is_stopped = || !asked_before && stop.load(Ordering::SeqCst);
    let stopped = || match is_stopped() {
        true => {
            let smooths = flag("resume");
            Err(Error::Interrupted(format!("while smoothing; all frames are tracked, {smooths} smooths them")))
        }
        false => Ok(()),
    };
    let mut written = 0;
    smooth(spool, pipeline, tree, stopped, |estimate| {
        results.append(&estimate)?;
        written += 1;
        (watch.progress)(RunPhase::Smooth, written, frames);
        Ok(if is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok(written)
}
