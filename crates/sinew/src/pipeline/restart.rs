//! A tracker that can be started anew elsewhere: for someone who was lost and is found again, and where a frame leaves it without a posterior.

use super::Observed;
use crate::Error;
use sinew_core::random::Stage;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{StepInfo, Tracker};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Where to start anew before the next step; shared with who finds people.
pub(super) type Pending = Arc<Mutex<Option<Vec<f64>>>>;

/// Makes a tracker that starts at a state.
pub(super) type Make = Box<dyn Fn(Vec<f64>) -> Result<Box<dyn Tracker<Observed>>, Error> + Send>;

/// Steps its tracker, or a new one where a start is pending or the old one failed.
pub(super) struct Restarting {
    tracker: Box<dyn Tracker<Observed>>,
    make: Make,
    pending: Pending,
    restarted: Restarted,
}

/// Whether the last step was that of a new tracker.
pub(super) type Restarted = Arc<AtomicBool>;

impl Restarting {
    pub(super) fn new(make: Make, start: Vec<f64>) -> Result<Self, Error> {
        Ok(Self { tracker: make(start)?, make, pending: Pending::default(), restarted: Restarted::default() })
    }

    pub(super) fn pending(&self) -> Pending {
        Arc::clone(&self.pending)
    }

    pub(super) fn restarted(&self) -> Restarted {
        Arc::clone(&self.restarted)
    }
}

impl Tracker<Observed> for Restarting {
    fn step(&mut self, observed: &Observed, stage: Stage) -> Result<StepInfo, sinew_tracking::Error> {
        let start = self.pending.lock().unwrap_or_else(PoisonError::into_inner).take();
        let [first, second] = stage.split(["first", "second"]);
        let new = start.and_then(|start| (self.make)(start).ok());
        self.restarted.store(new.is_some(), Ordering::Relaxed);
        if let Some(tracker) = new {
            self.tracker = tracker;
        }
        self.tracker.step(observed, first).or_else(|error| {
            let mut tracker = (self.make)(self.tracker.estimate().to_vec()).map_err(|_| error)?;
            let info = tracker.step(observed, second)?;
            self.tracker = tracker;
            self.restarted.store(true, Ordering::Relaxed);
            Ok(info)
        })
    }

    fn posterior(&self) -> Posterior<'_> {
        self.tracker.posterior()
    }

    fn estimate(&self) -> &[f64] {
        self.tracker.estimate()
    }
}
