//! A tracker that is made again elsewhere.
//!
//! For someone who was lost and is found, and where a frame has no posterior.

use crate::Error;
use crate::methods::{FrameLikelihood, Steps};
use sinew_core::random::Stage;
use sinew_tracking::posterior::Posterior;
use sinew_tracking::{Inferred, Resume, StepInfo, Tracker};

/// What a tracker gets of a frame.
pub struct Observation {
    /// The likelihood.
    pub likelihood: FrameLikelihood,
    /// Where the person is, if that is not where the tracker stands.
    pub restart: Option<Vec<f64>>,
}

/// Makes a tracker that starts at a state.
pub(super) type Make = Box<dyn Fn(Vec<f64>) -> Result<Box<dyn Steps>, Error> + Send>;

/// Steps its tracker, or a new one where the person is elsewhere or the old one failed.
pub(super) struct Restarting {
    tracker: Box<dyn Steps>,
    make: Make,
}

impl Restarting {
    pub(super) fn new(make: Make, start: Vec<f64>) -> Result<Self, Error> {
        Ok(Self { tracker: make(start)?, make })
    }
}

impl Resume for Restarting {
    fn save(&self) -> Vec<f64> {
        self.tracker.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), sinew_tracking::Error> {
        self.tracker.restore(saved)
    }
}

impl Tracker<Observation> for Restarting {
    fn step(&mut self, observed: &Observation, stage: Stage) -> Result<StepInfo, sinew_tracking::Error> {
        let [first, second] = stage.split(["first", "second"]);
        let elsewhere = observed.restart.clone().and_then(|start| (self.make)(start).ok());
        let restarted = elsewhere.is_some();
        if let Some(tracker) = elsewhere {
            self.tracker = tracker;
        }
        match self.tracker.step(&observed.likelihood, first) {
            Ok(info) => Ok(StepInfo { restarted, ..info }),
            Err(error) => {
                let mut tracker = (self.make)(self.tracker.estimate().to_vec()).map_err(|_| error)?;
                let info = tracker.step(&observed.likelihood, second)?;
                self.tracker = tracker;
                Ok(StepInfo { restarted: true, ..info })
            }
        }
    }
}

impl Inferred for Restarting {
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
    use sinew_observe::{KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel};
    use std::sync::Arc;

    /// Fails where its start is negative; remembers where it was started.
    struct Fragile(Vec<f64>);

    impl Tracker<FrameLikelihood> for Fragile {
        fn step(&mut self, _: &FrameLikelihood, _: Stage) -> Result<StepInfo, sinew_tracking::Error> {
            let broken = sinew_tracking::Error::Config { name: "start", value: self.0[0], expected: "not negative" };
            if self.0[0] < 0.0 { Err(broken) } else { Ok(StepInfo::default()) }
        }
    }

    impl Inferred for Fragile {
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
            mistakes: Mistakes::default(),
            isa: Isa::best(),
        };
        let observed = |restart| Observation {
            likelihood: FrameLikelihood::from(model.bind(KeypointFrame {
                detections: &[],
                elsewhere: &[],
                predicted: &[],
            })),
            restart,
        };
        // A tracker made where the old one failed stands one further.
        let further = |start: Vec<f64>| Box::new(Fragile(vec![start[0] + 1.0])) as Box<dyn Steps>;
        let mut tracker = Restarting::new(Box::new(move |start| Ok(further(start))), vec![-1.5]).unwrap();
        let step = |tracker: &mut Restarting, restart| {
            tracker.step(&observed(restart), Stage::new(1, "restart")).map(|info| info.restarted).ok()
        };
        assert_eq!(step(&mut tracker, None), Some(true));
        assert_eq!(tracker.estimate(), [0.5]);
        assert_eq!(step(&mut tracker, None), Some(false));
        assert_eq!(step(&mut tracker, Some(vec![4.0])), Some(true));
        assert_eq!(tracker.estimate(), [5.0]);
        tracker.restore(&[8.0]).unwrap();
        assert_eq!((tracker.estimate(), tracker.save()), (&[8.0][..], vec![8.0]));
        assert_eq!(step(&mut tracker, Some(vec![-7.0])), None);
    }
}
