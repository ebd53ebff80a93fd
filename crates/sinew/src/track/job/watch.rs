//! Who watches a run: a progress callback and the flag that stops it.

use crate::Error;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// Part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunPhase {
    /// Frames are read again, to see that they belong to the run that was stopped.
    Check,
    /// Frames are read for the set-up.
    SetUp,
    /// Frames are tracked.
    Track,
    /// Frames are smoothed.
    Smooth,
}

/// A progress callback and a stop flag.
pub struct Watch<'a> {
    /// Takes a pass, the frames done and all of them.
    pub progress: &'a mut (dyn FnMut(RunPhase, u64, u64) + Send),
    /// Set to end after the frame at hand.
    pub stop: &'a AtomicBool,
}

impl Watch<'_> {
    /// Whether the run is to stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// Whether the run continues.
    pub fn flow(&self) -> ControlFlow<()> {
        if self.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Refuses to continue once the run is to stop; `when` is the rest of the sentence "interrupted …".
    ///
    /// # Errors
    /// [`Error::Interrupted`].
    pub fn check(&self, when: &'static str) -> Result<(), Error> {
        if self.is_stopped() { Err(Error::Interrupted(when.into())) } else { Ok(()) }
    }
}
