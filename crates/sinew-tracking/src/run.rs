//! The one time loop: observe a frame, step the tracker, record what came out.

use crate::posterior::Posterior;
use crate::{Error, StepInfo, Tracker};
use sinew_core::random::Stage;
use std::borrow::Borrow;
use std::ops::ControlFlow;

/// What surrounds a tracker in a run: where its observations come from and where its posteriors go. One value does both, so that what it learns from a posterior is at hand when it binds the next frame.
pub trait Harness<O: ?Sized> {
    /// A bound observation.
    type Bound: Borrow<O>;
    /// What can go wrong around the tracker, or in it.
    type Error: From<Error>;

    /// Binds the observation of a frame, given the tracker's estimate so far.
    ///
    /// # Errors
    /// A frame that cannot be read or bound: the run ends with it.
    fn observe(&mut self, frame: u32, estimate: &[f64]) -> Result<Self::Bound, Self::Error>;

    /// Takes what a step gave, and may stop the run.
    ///
    /// # Errors
    /// Results that cannot be kept: the run ends with it.
    fn record(&mut self, frame: u32, info: StepInfo, posterior: Posterior<'_>) -> Result<ControlFlow<()>, Self::Error>;
}

/// Steps a tracker through `frames`.
///
/// For each frame `harness` binds the observation, the tracker steps with the `stage` of that frame, and `harness` records what came out. Nothing is kept here, so
/// memory does not grow; and since the stage depends on the frame alone, a run in two halves with the carried tracker gives the same bits as one.
///
/// # Errors
/// Errors of the harness, and of the tracker as [`Error::Frame`].
pub fn run<O: ?Sized, H: Harness<O> + ?Sized>(
    tracker: &mut (impl Tracker<O> + ?Sized),
    frames: impl IntoIterator<Item = u32>,
    stage: impl Fn(u32) -> Stage,
    harness: &mut H,
) -> Result<(), H::Error> {
    for frame in frames {
        let observed = harness.observe(frame, tracker.estimate())?;
        let info = tracker
            .step(observed.borrow(), stage(frame))
            .map_err(|source| Error::Frame { frame, source: Box::new(source) })?;
        if harness.record(frame, info, tracker.posterior())?.is_break() {
            break;
        }
    }
    Ok(())
}
