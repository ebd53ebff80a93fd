//! The multi-frame study: both filters on 25 frames of walking.
//!
//! 50 draws of the image noise, 10 and 28 degrees of freedom.
//!
//! For each frame: the log likelihood of the mean state, the log prior of the true state (the prior of the frame is a mixture about what the filter holds), and the
//! mean distance of the joints of the mean state from the true ones. The mean state of frame 10 is kept for Fig. 6.

use super::chains::{BURN_IN, Step};
use super::problem::{Likelihood, Model};
use super::scene::{self, Motion, Source};
use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::body::{Plan, point_positions};
use sinew::core::density::LogDensity as _;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::core::transition::Transition as _;
use sinew::dynamics::random_walk::RandomWalk;
use sinew::tracking::{Tracker, bootstrap, hmc_filter};

/// First recorded frame, counted from 1, and recorded frames a step.
const FIRST: usize = 60;
const STEP: usize = 4;
/// Frame whose mean states are kept.
pub(super) const SHOWN: usize = 10;

/// Number from 1 of the recorded frame of that step.
pub(super) const SHOWN_FRAME: usize = FIRST + STEP * (SHOWN - 1);

/// The filters that are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Filter {
    /// Particles N.
    Particles(usize),
    /// Updates R, with the paper's L.
    Hmc(usize, Step),
}

impl Filter {
    pub(super) const fn name(&self) -> &'static str {
        match self {
            Self::Particles(_) => "particle filter",
            Self::Hmc(..) => "hmc",
        }
    }

    fn tracker(
        &self,
        model: &Model,
        walk: RandomWalk,
        start: Vec<f64>,
        isa: Isa,
    ) -> Outcome<Box<dyn Tracker<Likelihood>>> {
        Ok(match self {
            Self::Particles(particles) => {
                let config = bootstrap::Config { particles: *particles, ..bootstrap::Config::default() };
                Box::new(bootstrap::Bootstrap::new(config, walk, start)?)
            }
            Self::Hmc(updates, step) => {
                let config = hmc_filter::Config {
                    chains: model.chains,
                    updates: *updates,
                    burn_in: BURN_IN,
                    step_size: step.eta,
                    leapfrog_steps: step.steps,
                    ..hmc_filter::Config::default()
                };
                Box::new(hmc_filter::HmcFilter::new(config, walk, start, isa)?)
            }
        })
    }
}

/// One run: all frames with one draw of the noise.
pub(super) fn run(
    motion: &Motion,
    source: Source,
    model: &Model,
    filter: &Filter,
    frames: usize,
    noise: usize,
    isa: Isa,
) -> Outcome<Value> {
    let camera = motion.camera(FIRST, isa);
    let walk = model.walk(isa)?;
    let plan = Plan::with_all_points(&motion.tree);
    let joints = |state: &[f64]| {
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(&plan, Isa::baseline(), state, &mut out);
        out
    };
    let first = motion.frame(FIRST, source)?;
    let mut tracker = filter.tracker(model, walk.clone(), model.part(&first.previous), isa)?;
    let to_observe = Stage::new(noise as u64, "choo-fleet noise");
    let to_track = Stage::new(noise as u64, "choo-fleet track").split([filter.name()]);
    let [to_track] = to_track;
    let (mut likelihoods, mut priors, mut errors, mut shown) = (vec![], vec![], vec![], vec![]);
    for index in 0..frames {
        let frame = motion.frame(FIRST + STEP * index, source)?;
        let truth = model.part(&frame.truth);
        let prior = if index == 0 {
            walk.log_density(&model.part(&frame.previous), &truth)
        } else {
            tracker.posterior().predictive_log_density(&walk, model.chains, &truth)
        };
        let seen = scene::seen(&camera, &frame.markers, to_observe.round(index));
        let whole = Box::new(sinew::observe::ObservationModel::bind(&camera, &seen));
        let likelihood = model.likelihood(whole, &frame.truth)?;
        let info = tracker.step(&likelihood, to_track.round(index))?;
        likelihoods.push(likelihood.log_density(&info.mean));
        priors.push(prior);
        let whole = model.complete(&frame.truth, &info.mean);
        let (found, truth) = (joints(&whole), joints(&frame.truth));
        let distances: Vec<f64> = found
            .chunks(3)
            .zip(truth.chunks(3))
            .map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt())
            .collect();
        errors.push(distances.iter().sum::<f64>() / distances.len() as f64);
        if index + 1 == SHOWN {
            shown = found;
        }
    }
    Ok(json!({ "log_likelihood": likelihoods, "log_prior": priors, "error_m": errors, "shown": shown }))
}
