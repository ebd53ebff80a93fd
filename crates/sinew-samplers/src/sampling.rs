//! From a density to chains that stand in its bulk: what `sample` of [`crate::nuts`], [`crate::hmc`] and [`crate::jumps`] share.
//!
//! 1. Chains start where the caller says, or uniformly around 0 ([`crate::starts`]).
//! 2. [`crate::warm_up`] takes them into the bulk and learns metric and step size.
//! 3. The kernel's own draws follow, with everything fixed.
//!
//! A density of single states has a block of lanes for each chain, one of blocks has eight chains a block ([`crate::chains`]).

use crate::Error;
use crate::chains::{ChainDraws, Schedule};
use crate::density::{Density, OneByOne};
use crate::hmc::kernel::Hmc;
use crate::run::Run;
use crate::starts::uniform_starts;
use crate::tuning::{self, StepSizeTrial, Tuned};
use crate::warm_up::{self, WarmedUp, warm_up};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES, set_lane};
use sinew_core::random::Stage;

/// Where chains start.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Starts {
    /// Uniform within ± this half width in every coordinate, drawn again where the density vanishes; 2 by default, as Stan's.
    Uniform(f64),
    /// One state for each chain.
    Given(Vec<Vec<f64>>),
}

impl Default for Starts {
    fn default() -> Self {
        Self::Uniform(2.0)
    }
}

/// What the settings of all kernels of chains have in common.
pub(crate) struct Plan<'a> {
    pub(crate) chains: usize,
    pub(crate) draws: usize,
    pub(crate) warm_up: usize,
    pub(crate) keep_warm_up: bool,
    pub(crate) acceptance: f64,
    pub(crate) max_depth: usize,
    pub(crate) starts: &'a Starts,
    pub(crate) seed: u64,
}

/// Chains after their warm-up.
pub(crate) struct Warm<'a> {
    /// The density for these chains.
    pub(crate) target: &'a dyn GradLogDensity,
    /// The density for full blocks.
    pub(crate) full: &'a dyn GradLogDensity,
    pub(crate) chains: usize,
    pub(crate) schedule: Schedule,
    pub(crate) warmed: WarmedUp,
    pub(crate) isa: Isa,
    /// For what a kernel tries out, and for its draws.
    pub(crate) trying: Stage,
    pub(crate) drawing: Stage,
}

impl Warm<'_> {
    /// Step size and length of trajectories by trial, and where the trial has left the chains, in full blocks.
    pub(crate) fn tuned(
        &self,
        lengths: &[usize],
        acceptance: f64,
        jitter: f64,
    ) -> Result<(Hmc, Tuned, Vec<Block>), Error> {
        let (metric, isa) = (&self.warmed.metric, self.isa);
        let states = blocks(&states_of(&self.warmed.states, self.target.dim(), self.chains), LANES);
        let mut trial = StepSizeTrial { target: self.full, metric, states, isa };
        let tolerance = 0.5 * (1.0 - acceptance).min(0.06);
        let config = tuning::Config {
            acceptance,
            tolerance,
            first_step_size: self.warmed.step_size,
            lengths: lengths.to_vec(),
            jitter,
            ..tuning::Config::default()
        };
        let tuned = match lengths {
            [steps] => tuning::step_size(&mut trial, *steps, &config, &self.trying)?,
            _ => tuning::length(&mut trial, &config, &self.trying)?,
        };
        let hmc = Hmc::with_metric(tuned.step_size, metric, tuned.leapfrog_steps, jitter, isa)?;
        Ok((hmc, tuned, trial.states))
    }
}

/// States in blocks of `width` lanes in use, whose idle lanes repeat them in turn.
pub(crate) fn blocks(states: &[Vec<f64>], width: usize) -> Vec<Block> {
    let dim = states[0].len();
    let mut blocks = vec![Block::ZERO; states.len().div_ceil(width) * dim];
    for (b, block) in blocks.chunks_exact_mut(dim).enumerate() {
        for lane in 0..LANES {
            let state = if width == LANES { b * LANES + lane } else { b };
            set_lane(block, lane, &states[state % states.len()]);
        }
    }
    blocks
}

/// The first states of blocks, eight or one of each.
fn states_of(blocks: &[Block], dim: usize, count: usize) -> Vec<Vec<f64>> {
    let width = crate::chains::width(blocks.len() / dim, count);
    let state = |i: usize| blocks[i / width * dim..][..dim].iter().map(|b| b.0[i % width]).collect();
    (0..count).map(state).collect()
}

impl Plan<'_> {
    fn check(&self, dim: usize) -> Result<(), Error> {
        if self.chains == 0 || dim == 0 {
            return Err(Error::Empty { count: self.chains, dim });
        }
        if self.draws == 0 {
            return Err(Error::OutOfRange { name: "number of draws", value: 0.0, expected: "must be at least 1" });
        }
        if !(self.acceptance > 0.0 && self.acceptance < 1.0) {
            let (name, value) = ("acceptance", self.acceptance);
            return Err(Error::OutOfRange { name, value, expected: "must be between 0 and 1" });
        }
        let Starts::Given(starts) = self.starts else { return Ok(()) };
        let wrong = starts.iter().find(|start| start.len() != dim);
        match wrong {
            _ if starts.len() != self.chains => {
                Err(Error::Length { what: "the list of starts", found: starts.len(), expected: self.chains })
            }
            Some(start) => Err(Error::Length { what: "a start", found: start.len(), expected: dim }),
            None => Ok(()),
        }
    }

    /// Warms chains up and hands them to `draw`, which makes their draws.
    pub(crate) fn run(
        &self,
        density: &dyn Density,
        draw: impl FnOnce(Warm<'_>) -> Result<Run, Error>,
    ) -> Result<Run, Error> {
        let dim = density.dim();
        self.check(dim)?;
        let one = OneByOne { density, lanes: 1 };
        let eight = OneByOne { density, lanes: LANES };
        let (target, full, width): (&dyn GradLogDensity, &dyn GradLogDensity, usize) = match density.by_blocks() {
            Some(blocks) => (blocks, blocks, LANES),
            None => (&one, &eight, 1),
        };
        let isa = Isa::best();
        let [starting, warming, trying, drawing] =
            Stage::new(self.seed, "sample").split(["start", "warm up", "try", "draw"]);
        let states = match self.starts {
            Starts::Given(states) => states.clone(),
            Starts::Uniform(half_width) => {
                states_of(&uniform_starts(full, *half_width, self.chains, &starting)?, dim, self.chains)
            }
        };
        let config = warm_up::Config {
            acceptance: self.acceptance,
            max_depth: self.max_depth,
            keep_draws: self.keep_warm_up,
            ..warm_up::Config::with_length(self.warm_up)?
        };
        let mut warmed = warm_up(target, &blocks(&states, width), self.chains, &config, isa, &warming)?;
        let windows = std::mem::take(&mut warmed.draws);
        let schedule = Schedule { updates: self.draws, burn_in: 1 };
        let chains = self.chains;
        let run = draw(Warm { target, full, chains, schedule, warmed, isa, trying, drawing })?;
        let warm_up = self.keep_warm_up.then(|| Box::new(joined(density.names(), &windows)));
        Ok(Run { warm_up, ..run })
    }
}

/// The windows of a warm-up as one run.
fn joined(names: Vec<String>, windows: &[ChainDraws]) -> Run {
    let windows: Vec<Run> = windows.iter().map(|draws| Run::from_blocks(names.clone(), draws)).collect();
    let mut all =
        Run { names, chains: windows.first().map_or(0, |run| run.chains), step_size: f64::NAN, ..Run::default() };
    for chain in 0..all.chains {
        for run in &windows {
            let numbers = run.draws() * run.dim();
            all.states.extend_from_slice(&run.states[chain * numbers..][..numbers]);
            all.stats.extend_from_slice(run.chain_stats(chain));
        }
    }
    all
}

/// A run of chains with names that fit.
pub(crate) fn named(density: &dyn Density, draws: &ChainDraws) -> Result<Run, Error> {
    let (names, expected) = (density.names(), density.dim());
    if names.len() != expected {
        return Err(Error::Length { what: "the list of names", found: names.len(), expected });
    }
    Ok(Run::from_blocks(names, draws))
}
