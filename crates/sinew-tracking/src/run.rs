//! The one time loop: observe a frame, step the tracker, note what the next frame needs, record the rest.
//!
//! A step leaves two kinds of work. What the next frame needs is done at once ([`Harness::note`]). The rest ([`Harness::record`]) is done beside the next step, which another thread takes if one is idle.
//! All that is passed on belongs to one frame, so the number of threads changes nothing.

use crate::posterior::{Copied, Posterior};
use crate::{Error, StepInfo, Tracker};
use sinew_core::random::Stage;
use std::borrow::Borrow;
use std::ops::ControlFlow;

/// What surrounds a tracker in a run: where its observations come from and where its posteriors go. One value does both, so that what it learns from a posterior is at hand when it binds the next frame.
pub trait Harness<O: ?Sized> {
    /// A bound observation.
    type Bound: Borrow<O> + Sync;
    /// What a step leaves to be recorded.
    type Noted;
    /// What can go wrong around the tracker, or in it.
    type Error: From<Error>;

    /// Binds the observation of a frame, given the tracker's estimate so far.
    ///
    /// # Errors
    /// A frame that cannot be read or bound: the run ends with it.
    fn observe(&mut self, frame: u32, estimate: &[f64]) -> Result<Self::Bound, Self::Error>;

    /// Takes in what a step gave, as far as the next frame needs it.
    ///
    /// # Errors
    /// A step that cannot be taken in: the run ends with it.
    fn note(&mut self, frame: u32, info: StepInfo) -> Result<Self::Noted, Self::Error>;

    /// Takes in the rest, with the posterior, after the next frame has been observed.
    ///
    /// # Errors
    /// Results that cannot be kept: the run ends with it.
    fn record(&mut self, noted: Self::Noted, posterior: Posterior<'_>) -> Result<(), Self::Error>;

    /// Whether to stop; asked before every frame but the first. The frame before is still recorded.
    fn flow(&mut self) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Steps a tracker through `frames`.
///
/// For each frame `harness` binds the observation, the tracker steps with the `stage` of that frame, and `harness` notes what came out, and records it beside the next step.
/// Nothing is kept here but one frame, so memory does not grow; and since the stage depends on the frame alone, a run in two halves with the carried tracker gives the same bits as one.
///
/// # Errors
/// Errors of the harness, and of the tracker as [`Error::Frame`]. Frames before the one that failed are recorded.
pub fn run<O: ?Sized, H: Harness<O> + ?Sized>(
    tracker: &mut (impl Tracker<O> + ?Sized),
    frames: impl IntoIterator<Item = u32>,
    stage: impl Fn(u32) -> Stage,
    harness: &mut H,
) -> Result<(), H::Error> {
    let (mut noted, mut last, mut failed) = (None, Copied::default(), Ok(()));
    for frame in frames {
        if noted.is_some() && harness.flow().is_break() {
            break;
        }
        let observed = match harness.observe(frame, tracker.estimate()) {
            Ok(observed) => observed,
            Err(error) => {
                failed = Err(error);
                break;
            }
        };
        let (stage, mut stepped) = (stage(frame), Ok(StepInfo::default()));
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| stepped = tracker.step(observed.borrow(), stage));
            noted.take().map_or(Ok(()), |noted| harness.record(noted, last.view()))
        })?;
        let info = stepped.map_err(|source| Error::Frame { frame, source: Box::new(source) })?;
        noted = Some(harness.note(frame, info)?);
        last.take(tracker.posterior());
    }
    if let Some(noted) = noted {
        harness.record(noted, last.view())?;
    }
    failed
}
