//! A particle filter of any state-space model, in one call.
//!
//! The model x_0 ~ p(x_0), x_t ~ p(x_t | x_{t−1}), y_t ~ p(y_t | x_t) is a [`StateSpace`]: two draws and one log density. [`filter`] runs the bootstrap filter ([`crate::bootstrap`]) over all observations;
//! [`filter_with_history`] keeps every frame's particles as well, from which [`History`] draws trajectories.
//!
//! ```
//! use sinew_tracking::{BlockRng, state_space::{Settings, StateSpace, filter}};
//!
//! /// Log volatility of returns: x_t = 0.98 x_{t−1} + 0.15 ε, y_t ~ N(0, exp x_t).
//! struct Volatility;
//! impl StateSpace for Volatility {
//!     type Observation = f64;
//!     fn dim(&self) -> usize {
//!         1
//!     }
//!     fn draw_first(&self, x: &mut [f64], rng: &mut BlockRng) {
//!         x[0] = 0.75 * rng.normal();
//!     }
//!     fn draw_next(&self, _frame: usize, before: &[f64], x: &mut [f64], rng: &mut BlockRng) {
//!         x[0] = 0.98 * before[0] + 0.15 * rng.normal();
//!     }
//!     fn log_density(&self, _frame: usize, y: &f64, x: &[f64]) -> f64 {
//!         -0.5 * (y * y * (-x[0]).exp() + x[0] + std::f64::consts::TAU.ln())
//!     }
//! }
//! let returns = [0.3, -1.2, 0.8, 2.5, -2.1, 0.1];
//! let filtered = filter(&Volatility, &returns, Settings { particles: 2000, seed: 42, ..Settings::default() })?;
//! assert!((filtered.log_evidence + 11.68).abs() < 0.1, "{}", filtered.log_evidence);
//! let last = &filtered.frames[5];
//! println!("x = {:.2} ± {:.2}, effective number {:.0}", last.mean[0], last.sd[0], last.ess);
//! # Ok::<(), sinew_tracking::Error>(())
//! ```
//!
//! Results depend on model, observations and settings, on no number of threads and, where the model has scalar methods and draws by [`BlockRng::normal`], on no instruction set. Time and memory are O(particles) a frame, of a history O(particles · frames).

use crate::bootstrap::{Bootstrap, Config};
use crate::posterior::Posterior;
use crate::{Error, Harness, Inferred, StepInfo, Tracker, run};
use rayon::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, LANES, get_lane};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::{MotionModel, Transition, lane_by_lane};
use sinew_samplers::resample::{Ancestors, Scheme, systematic};
use sinew_samplers::weights::normalise;

/// A state-space model. Frame 0 is the first; all methods are called from several threads.
pub trait StateSpace: Sync {
    /// What is observed in one frame; of a frame without observation an `Option` says so, with log density 0.
    type Observation: Sync;

    /// Dimension of the state.
    fn dim(&self) -> usize;

    /// Draws a state of frame 0.
    fn draw_first(&self, state: &mut [f64], rng: &mut BlockRng);

    /// Draws a state of `frame` ≥ 1 from the one before.
    fn draw_next(&self, frame: usize, previous: &[f64], next: &mut [f64], rng: &mut BlockRng);

    /// log p(observation | state): finite, or −∞ where it cannot be.
    fn log_density(&self, frame: usize, observation: &Self::Observation, state: &[f64]) -> f64;

    /// [`StateSpace::draw_next`] of a block of eight states (see [`sinew_core::lanes`]), to be written where speed counts; by default one after the other.
    fn draw_next_block(&self, frame: usize, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        lane_by_lane(previous, next, |previous, next| self.draw_next(frame, previous, next, rng));
    }

    /// [`StateSpace::log_density`] of a block of eight states; by default one after the other.
    fn log_density_block(&self, frame: usize, observation: &Self::Observation, states: &[Block]) -> Block {
        let mut values = [Block::ZERO];
        lane_by_lane(states, &mut values, |state, value| value[0] = self.log_density(frame, observation, state));
        values[0]
    }
}

/// A state-space model that knows the density of its steps, which backward sampling asks for.
pub trait TransitionDensity: StateSpace {
    /// log p(next | previous), the step from `frame` − 1 to `frame`, up to a constant.
    fn log_transition(&self, frame: usize, previous: &[f64], next: &[f64]) -> f64;
}

/// Settings of [`filter`].
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Number of particles N.
    pub particles: usize,
    /// Resampling scheme.
    pub scheme: Scheme,
    /// The particles are resampled where N_eff / N is at most this: 1 means always, 0 never.
    pub resample_below: f64,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { particles: 1000, scheme: Scheme::Systematic, resample_below: 0.5, seed: 0 }
    }
}

/// What [`filter`] found.
#[derive(Clone, Debug, PartialEq)]
pub struct FilterRun {
    /// Estimate of log p(y_0 … y_T), unbiased on the natural scale.
    pub log_evidence: f64,
    /// One entry a frame.
    pub frames: Vec<FrameBelief>,
}

/// One frame's posterior p(x_t | y_0 … y_t) in short.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameBelief {
    /// Mean of the state.
    pub mean: Vec<f64>,
    /// Standard deviation of each coordinate.
    pub sd: Vec<f64>,
    /// Effective number of particles 1 / Σ W².
    pub ess: f64,
    /// Estimate of log p(y_t | y_0 … y_{t−1}).
    pub log_evidence: f64,
    /// Whether the particles were resampled before this frame.
    pub resampled: bool,
}

/// Filters all observations, one a frame.
///
/// # Errors
/// [`Error::Config`] and [`Error::Samplers`] for settings or a model without dimension; [`Error::Frame`] with the frame that no particle explains, or whose log density is NaN or +∞.
pub fn filter<M: StateSpace>(
    model: &M,
    observations: &[M::Observation],
    settings: Settings,
) -> Result<FilterRun, Error> {
    Ok(filtered(model, observations, &settings, false)?.0)
}

/// [`filter`] that keeps the particles of all frames.
///
/// # Errors
/// As [`filter`].
pub fn filter_with_history<M: StateSpace>(
    model: &M,
    observations: &[M::Observation],
    settings: Settings,
) -> Result<(FilterRun, History), Error> {
    filtered(model, observations, &settings, true)
}

fn filtered<M: StateSpace>(
    model: &M,
    observations: &[M::Observation],
    settings: &Settings,
    keeps: bool,
) -> Result<(FilterRun, History), Error> {
    let &Settings { particles, scheme, resample_below, seed } = settings;
    let (dim, config) = (model.dim(), Config { particles, scheme, resample_below });
    let bootstrap = Bootstrap::new(config, Motion { model, frame: 0 }, vec![0.0; dim])?;
    let mut keeper = Keeper { bootstrap, keeps, history: History { dim, frames: vec![] } };
    let mut summary = Summary { model, observations, frames: Vec::with_capacity(observations.len()) };
    let stage = |frame| Stage::new(seed, "state space").at_frame(frame);
    // Inside the pool of threads from the start, a step needs no other thread to be woken.
    rayon::scope(|_| run(&mut keeper, 0..observations.len() as u32, stage, &mut summary))?;
    let log_evidence = summary.frames.iter().map(|frame| frame.log_evidence).sum();
    Ok((FilterRun { log_evidence, frames: summary.frames }, keeper.history))
}

/// The model's steps as a motion, which counts the frames.
#[derive(Clone, Debug)]
struct Motion<'a, M> {
    model: &'a M,
    frame: usize,
}

impl<M: StateSpace> MotionModel for Motion<'_, M> {
    fn dim(&self) -> usize {
        self.model.dim()
    }
    fn follow(&mut self, _before: Option<&[f64]>, _estimate: &[f64]) {
        self.frame += 1;
    }
}

impl<M: StateSpace> Transition for Motion<'_, M> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        self.model.draw_next_block(self.frame, previous, next, rng);
    }

    fn sample_initial_block(&self, _centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        lane_by_lane(&[], next, |_, state| self.model.draw_first(state, rng));
    }

    /// No bootstrap filter asks for it, and no [`StateSpace`] says it.
    fn log_density(&self, _previous: &[f64], _next: &[f64]) -> f64 {
        f64::NAN
    }
}

/// One frame's observation as a density of the state.
struct Observed<'a, M: StateSpace> {
    model: &'a M,
    frame: usize,
    observation: &'a M::Observation,
}

impl<M: StateSpace> LogDensity for Observed<'_, M> {
    fn dim(&self) -> usize {
        self.model.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.model.log_density(self.frame, self.observation, x)
    }
    fn log_density_block(&self, x: &[Block], _ws: &mut [Block]) -> Block {
        self.model.log_density_block(self.frame, self.observation, x)
    }
}

/// The filter, and what it leaves of each frame where that is kept.
struct Keeper<'a, M> {
    bootstrap: Bootstrap<Motion<'a, M>>,
    keeps: bool,
    history: History,
}

impl<M: StateSpace> Inferred for Keeper<'_, M> {
    fn posterior(&self) -> Posterior<'_> {
        self.bootstrap.posterior()
    }
    fn estimate(&self) -> &[f64] {
        self.bootstrap.estimate()
    }
}

impl<'a, M: StateSpace> Tracker<Observed<'a, M>> for Keeper<'a, M> {
    fn step(&mut self, observed: &Observed<'a, M>, stage: Stage) -> Result<StepInfo, Error> {
        let info = self.bootstrap.step(observed, stage)?;
        if self.keeps {
            let particles = self.bootstrap.particles();
            self.history.frames.push(Kept {
                states: particles.states().to_vec(),
                weights: particles.weights().to_vec(),
                ancestors: particles.ancestors().to_vec(),
            });
        }
        Ok(info)
    }
}

/// What surrounds the filter.
struct Summary<'a, M: StateSpace> {
    model: &'a M,
    observations: &'a [M::Observation],
    frames: Vec<FrameBelief>,
}

impl<'a, M: StateSpace> Harness<Observed<'a, M>> for Summary<'a, M> {
    type Bound = Observed<'a, M>;
    type Noted = StepInfo;
    type Error = Error;

    fn observe(&mut self, frame: u32, _estimate: &[f64]) -> Result<Self::Bound, Error> {
        let frame = frame as usize;
        Ok(Observed { model: self.model, frame, observation: &self.observations[frame] })
    }

    fn note(&mut self, _frame: u32, info: StepInfo) -> Result<StepInfo, Error> {
        Ok(info)
    }

    fn record(&mut self, info: StepInfo, posterior: Posterior<'_>) -> Result<(), Error> {
        let StepInfo { mean, ess, log_evidence, resampled, .. } = info;
        self.frames.push(FrameBelief {
            sd: posterior.sd(&mean),
            mean,
            ess,
            log_evidence: log_evidence.unwrap_or_default(),
            resampled: resampled.unwrap_or_default(),
        });
        Ok(())
    }
}

/// One frame's particles.
#[derive(Clone, Debug)]
struct Kept {
    states: Vec<Block>,
    weights: Vec<f64>,
    /// Places in the frame before; nothing where each came from itself.
    ancestors: Ancestors,
}

/// The particles of all frames of a filter, from which trajectories are drawn: x_0 … x_T given y_0 … y_T. A trajectory is dim numbers a frame, one frame after the other.
#[derive(Clone, Debug)]
pub struct History {
    dim: usize,
    frames: Vec<Kept>,
}

impl History {
    /// `draws` trajectories along the ancestors of last particles. Costs next to nothing; but all of them share their early frames, so that those are known only where the frames are few or the particles many.
    #[must_use]
    pub fn genealogies(&self, draws: usize, seed: u64) -> Vec<Vec<f64>> {
        let Some(last) = self.frames.last() else { return vec![vec![]; draws] };
        let chosen = systematic(&last.weights, draws, &mut Stage::new(seed, "genealogies").whole());
        chosen.into_iter().map(|index| self.genealogy(index)).collect()
    }

    fn genealogy(&self, mut index: usize) -> Vec<f64> {
        let mut trajectory = vec![0.0; self.frames.len() * self.dim];
        for (frame, state) in self.frames.iter().zip(trajectory.chunks_exact_mut(self.dim)).rev() {
            self.state(frame, index, state);
            index = frame.ancestors.get(index).copied().unwrap_or(index);
        }
        trajectory
    }

    /// `draws` trajectories by backward sampling (Godsill, Doucet & West 2004): from the last frame back, each state with probability W_i p(next | x_i). They are independent given the particles, and cost `draws` · frames · particles densities of a step.
    ///
    /// # Errors
    /// [`Error::Frame`] where no particle leads to the state that was drawn for the frame after, or a density is NaN or +∞.
    pub fn backward_samples<M: TransitionDensity>(
        &self,
        model: &M,
        draws: usize,
        seed: u64,
    ) -> Result<Vec<Vec<f64>>, Error> {
        let stage = Stage::new(seed, "backward sampling");
        let draw = |k: usize| self.backward_sample(model, &mut stage.block(k as u32));
        (0..draws).into_par_iter().map(draw).collect()
    }

    fn backward_sample<M: TransitionDensity>(&self, model: &M, rng: &mut BlockRng) -> Result<Vec<f64>, Error> {
        let mut trajectory = vec![0.0; self.frames.len() * self.dim];
        let (mut log_weights, mut weights, mut state) = (vec![], vec![], vec![0.0; self.dim]);
        for (t, frame) in self.frames.iter().enumerate().rev() {
            let (before, after) = trajectory.split_at_mut((t + 1) * self.dim);
            log_weights.clear();
            log_weights.extend(frame.weights.iter().enumerate().map(|(i, weight)| {
                let step = after.get(..self.dim).map_or(0.0, |next| {
                    self.state(frame, i, &mut state);
                    model.log_transition(t + 1, &state, next)
                });
                weight.ln() + step
            }));
            normalise(&log_weights, &mut weights)
                .map_err(|source| Error::Frame { frame: t as u32, source: Box::new(source.into()) })?;
            let chosen = systematic(&weights, 1, rng)[0];
            self.state(frame, chosen, &mut before[t * self.dim..]);
        }
        Ok(trajectory)
    }

    fn state(&self, frame: &Kept, index: usize, state: &mut [f64]) {
        get_lane(&frame.states[index / LANES * self.dim..][..self.dim], index % LANES, state);
    }
}
