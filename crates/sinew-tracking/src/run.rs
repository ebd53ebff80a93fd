//! The one time loop.

use crate::posterior::Posterior;
use crate::{Error, StepInfo, Tracker};
use sinew_core::random::Stage;
use std::borrow::Borrow;
use std::ops::ControlFlow;

/// Steps a tracker through `frames`.
///
/// For each frame `observe` binds the observation, knowing the tracker's estimate so far; the tracker steps with the stage of that frame; `record` takes what came out and may stop the run. Nothing is kept here, so
/// memory does not grow; and since the stage depends on the frame alone, a run in two halves with the carried tracker gives the same bits as one.
///
/// # Errors
/// Those of `observe` and `record`, and of the tracker as [`Error::Frame`].
pub fn run<O, B, E>(
    tracker: &mut (impl Tracker<O> + ?Sized),
    frames: impl IntoIterator<Item = u32>,
    stage: impl Fn(u32) -> Stage,
    mut observe: impl FnMut(u32, &[f64]) -> Result<B, E>,
    mut record: impl FnMut(u32, StepInfo, Posterior<'_>) -> Result<ControlFlow<()>, E>,
) -> Result<(), E>
where
    O: ?Sized,
    B: Borrow<O>,
    E: From<Error>,
{
    for frame in frames {
        let observed = observe(frame, tracker.estimate())?;
        let info = tracker
            .step(observed.borrow(), stage(frame))
            .map_err(|source| Error::Frame { frame, source: Box::new(source) })?;
        if record(frame, info, tracker.posterior())?.is_break() {
            break;
        }
    }
    Ok(())
}
