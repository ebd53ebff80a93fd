//! A tracker that can be started anew elsewhere: for someone who was lost and is found again, and where a frame leaves it without a posterior.

use super::observed::Observed;
use crate::Error;
use sinew_core::random::Stage;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Resume, StepInfo, Tracker};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// Where to start anew before the next step; shared with who finds people.
pub(super) type Pending = Arc<Mutex<Option<Vec<f64>>>>;

/// What is asked of a tracker here: that it steps, and that its state can be put down.
pub trait Steps: Tracker<Observed> + Resume {}

impl<T: Tracker<Observed> + Resume> Steps for T {}

/// Makes a tracker that starts at a state.
pub(super) type Make = Box<dyn Fn(Vec<f64>) -> Result<Box<dyn Steps>, Error> + Send>;

/// Steps its tracker, or a new one where a start is pending or the old one failed.
pub(super) struct Restarting {
    tracker: Box<dyn Steps>,
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

/// A start that is pending and whether the last step was that of a new tracker mean nothing between two frames.
impl Resume for Restarting {
    fn save(&self) -> Vec<f64> {
        self.tracker.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), sinew_tracking::Error> {
        self.tracker.restore(saved)
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

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::standard::h32;
    use sinew_body::{Plan, Proportions};
    use sinew_core::lanes::Isa;
    use sinew_observe::{KeypointFrame, KeypointModel, Noise, ObservationModel};

    /// Fails where its start is negative; remembers where it was started.
    struct Fragile(Vec<f64>);

    impl Tracker<Observed> for Fragile {
        fn step(&mut self, _: &Observed, _: Stage) -> Result<StepInfo, sinew_tracking::Error> {
            let broken = sinew_tracking::Error::Config { name: "start", value: self.0[0], expected: "not negative" };
            if self.0[0] < 0.0 { Err(broken) } else { Ok(StepInfo::default()) }
        }
        fn posterior(&self) -> Posterior<'_> {
            Posterior { dim: 1, states: &[], weights: &[], effective: 0.0, chain_stats: &[] }
        }
        fn estimate(&self) -> &[f64] {
            &self.0
        }
    }

    impl Resume for Fragile {
        fn save(&self) -> Vec<f64> {
            self.0.clone()
        }
        fn restore(&mut self, saved: &[f64]) -> Result<(), sinew_tracking::Error> {
            self.0 = saved.to_vec();
            Ok(())
        }
    }

    #[test]
    fn a_failed_step_is_taken_again_by_a_new_tracker() {
        let model = KeypointModel {
            plan: Arc::new(Plan::with_all_points(&h32(&Proportions::default()))),
            views: vec![],
            noise: Noise::OutlierFloor { outlier: 0.02 },
            model_error_m: 0.01,
            least_confidence: 0.1,
            isa: Isa::best(),
        };
        let observed = Observed::from(model.bind(KeypointFrame { detections: &[], predicted: &[] }));
        // A tracker made where the old one failed stands one further.
        let further = |start: Vec<f64>| Box::new(Fragile(vec![start[0] + 1.0])) as Box<dyn Steps>;
        let mut tracker = Restarting::new(Box::new(move |start| Ok(further(start))), vec![-1.5]).unwrap();
        let restarted = tracker.restarted();
        let step = |tracker: &mut Restarting| tracker.step(&observed, Stage::new(1, "restart")).is_ok();
        assert!(step(&mut tracker) && restarted.load(Ordering::Relaxed));
        assert_eq!(tracker.estimate(), [0.5]);
        assert!(step(&mut tracker) && !restarted.load(Ordering::Relaxed));
        *tracker.pending().lock().unwrap() = Some(vec![4.0]);
        assert!(step(&mut tracker) && restarted.load(Ordering::Relaxed));
        assert_eq!(tracker.estimate(), [5.0]);
        tracker.restore(&[8.0]).unwrap();
        assert_eq!((tracker.estimate(), tracker.save()), (&[8.0][..], vec![8.0]));
        *tracker.pending().lock().unwrap() = Some(vec![-7.0]);
        assert!(!step(&mut tracker));
    }
}
