//! The forward pass of a run: frames are tracked and written, with a checkpoint at fixed intervals.

use super::inputs::hashes;
use super::keeper::Keeper;
use super::watch::{RunPhase, Watch};
use crate::Error;
use crate::input::source::{FrameSource, InputHashes};
use crate::input::upright::Upright;
use crate::track::pipeline::{KeepFrames, Pipeline};
use sinew_results::estimate::FrameEstimate;
use sinew_tracking::posterior::Posterior;
use std::ops::ControlFlow;

/// Tracks the frames that the keeper's checkpoint has not.
///
/// # Errors
/// Failures after which there is nothing to write: of the disk, and before the first frame. Other failures are the value: what was done before them is written.
pub(super) fn forward<S: FrameSource>(
    keeper: &mut Keeper,
    pipeline: &mut Pipeline,
    source: &mut Upright<'_, S>,
    of_settings: &InputHashes,
    watch: &mut Watch<'_>,
) -> Result<Result<(), Error>, Error> {
    let (frames, before) = (source.frames(), keeper.checkpoint.done);
    let total = frames.end - frames.start;
    loop {
        let next = frames.start + keeper.checkpoint.done;
        let writing = Writing { keeper, watch, total };
        // The turn of the world is in the cameras, and what is tracked is no part of the set-up's reading.
        let tracked = pipeline.track(source.source_mut(), next..frames.end, writing);
        let is_last = keeper.checkpoint.done == total;
        match tracked {
            Err(error) if keeper.checkpoint.done == before || error.file().is_some() => return Err(error),
            Err(error) => return Ok(Err(error)),
            Ok(()) if is_last && keeper.spool.is_none() => return Ok(Ok(())),
            Ok(()) => keeper.keep(pipeline, source.read(), hashes(source, of_settings))?,
        }
        if is_last || watch.is_stopped() {
            return Ok(Ok(()));
        }
    }
}

/// Writes each frame, until a checkpoint is due or the run is to stop.
struct Writing<'a, 'w> {
    keeper: &'a mut Keeper,
    watch: &'a mut Watch<'w>,
    total: u64,
}

impl KeepFrames for Writing<'_, '_> {
    fn keep(&mut self, estimate: FrameEstimate, _: &Posterior<'_>) -> Result<(), Error> {
        let Self { keeper, watch, total } = self;
        keeper.take(estimate, |_| ())?;
        if keeper.checkpoint.done == *total {
            (watch.progress)(RunPhase::Track, *total, *total);
        }
        Ok(())
    }

    fn seed(&mut self, seed: u64) {
        self.keeper.seed(seed);
    }

    fn flow(&mut self) -> ControlFlow<()> {
        let Self { keeper, watch, total, .. } = self;
        // The last frame is tracked, and still to be kept.
        (watch.progress)(RunPhase::Track, keeper.checkpoint.done + 1, *total);
        if keeper.is_due() { ControlFlow::Break(()) } else { watch.flow() }
    }
}
