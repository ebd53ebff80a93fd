//! CONDENSATION with the motion model of the coarse-to-fine tracker (eq. 2) without its grid: s(t + 1) = s(t) + A (X̂(t) − X̂(t − 1)) + B ω, A = 0.2 I, B = diag(δ), X̂ the weighted means of the last two frames.
//!
//! The transition changes from frame to frame with the drift. The bootstrap filter owns its transition, so that it is made anew for each frame and takes up its particles.

use super::Outcome;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::Transition;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::observe::image_likelihood::ImageLikelihood;
use sinew::tracking::bootstrap::{Bootstrap, Config};
use sinew::tracking::{Resume as _, StepInfo, Tracker as _};

/// A random walk from where the drift leads.
#[derive(Clone)]
struct Drifting {
    walk: RandomWalk,
    drift: Vec<f64>,
}

impl Transition for Drifting {
    fn dim(&self) -> usize {
        self.walk.dim()
    }

    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        self.walk.sample_block(previous, next, rng);
        for (next, drift) in next.iter_mut().zip(&self.drift) {
            next.0.iter_mut().for_each(|x| *x += drift);
        }
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let moved: Vec<f64> = previous.iter().zip(&self.drift).map(|(x, drift)| x + drift).collect();
        self.walk.log_density(&moved, next)
    }
}

/// The filter.
pub(super) struct Condensation {
    config: Config,
    filter: Bootstrap<Drifting>,
    walk: RandomWalk,
    /// The part A of the last change by which particles move on.
    part: f64,
    before: Option<Vec<f64>>,
    start: Vec<f64>,
}

impl Condensation {
    /// A filter with steps `sd` a frame that starts at a pose.
    pub(super) fn new(particles: usize, sd: &[f64], part: f64, start: &[f64], isa: Isa) -> Outcome<Self> {
        let walk = RandomWalk::new(sd, 1.0, Between::Mixture, isa)?;
        let config = Config { particles, ..Config::default() };
        let still = Drifting { walk: walk.clone(), drift: vec![0.0; sd.len()] };
        let filter = Bootstrap::new(config.clone(), still, start.to_vec())?;
        Ok(Self { config, filter, walk, part, before: None, start: start.to_vec() })
    }

    /// One frame.
    pub(super) fn step(&mut self, observed: &ImageLikelihood, stage: Stage) -> Outcome<StepInfo> {
        let info = self.filter.step(observed, stage)?;
        let change =
            |before: &Vec<f64>| info.mean.iter().zip(before).map(|(to, from)| self.part * (to - from)).collect();
        let drift = self.before.as_ref().map_or_else(|| vec![0.0; info.mean.len()], change);
        let saved = self.filter.save();
        let moving = Drifting { walk: self.walk.clone(), drift };
        self.filter = Bootstrap::new(self.config.clone(), moving, self.start.clone())?;
        self.filter.restore(&saved)?;
        self.before = Some(info.mean.clone());
        Ok(info)
    }

    /// The filter of the last frame.
    pub(super) const fn filter(&self) -> &impl sinew::tracking::Tracker<ImageLikelihood> {
        &self.filter
    }
}
