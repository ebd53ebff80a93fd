//! A hybrid Monte Carlo filter's first frame (Choo & Fleet 2001, §5).
//!
//! Chains from weighted draws of the prior; the estimate is the mean of what follows the burn-in.

use super::problem::Problem;
use crate::support::outcome::Outcome;
use sinew::core::lanes::{Block, LANES};
use sinew::core::random::Stage;
use sinew::samplers::chains::{ChainDraws, Schedule, draw_trajectories};
use sinew::samplers::curvature::curvature;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::laplace::laplace;
use sinew::samplers::metric::Metric;
use sinew::samplers::moments;
use sinew::samplers::starts::{importance_starts, laplace_starts};
use sinew::samplers::tuning::{self, StepSizeTrial};

/// Samples of each chain that are discarded.
pub(super) const BURN_IN: usize = 6;
/// Draws of the prior from which the curvature is taken.
pub(super) const CURVATURE_DRAWS: usize = 64;

/// Updates from which the effective number of draws of a length is taken: short runs flatter lengths that hardly move.
const TUNING_UPDATES: usize = 2000;

/// How trajectories move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Variant {
    /// The paper's L, diagonal metric, step size tuned again.
    Paper,
    /// Diagonal metric, L and step size tuned.
    Best,
    /// Dense metric and starts from the Laplace approximation, L and step size tuned, jitter: the preset for real recordings.
    Dense,
}

impl Variant {
    pub(super) const ALL: [Self; 3] = [Self::Paper, Self::Best, Self::Dense];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Paper => "hmc, paper's L",
            Self::Best => "hmc, best L",
            Self::Dense => "hmc, dense metric",
        }
    }

    pub(super) const fn jitter(self) -> f64 {
        match self {
            Self::Paper | Self::Best => 0.0,
            Self::Dense => 0.2,
        }
    }

    /// Trajectory lengths to choose from.
    fn lengths(self, problem: &Problem) -> Vec<usize> {
        match self {
            Self::Paper => vec![problem.model.steps],
            Self::Best => vec![1, 2, 5, 10, 20, 40, 80],
            Self::Dense => vec![1, 2, 3, 4, 5, 6, 7, 8, 10],
        }
    }
}

/// Step size and length, fixed before the study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    pub(super) eta: f64,
    pub(super) steps: usize,
    pub(super) acceptance: f64,
}

fn start(problem: &Problem, variant: Variant, chains: usize, stage: Stage) -> Outcome<(Vec<Block>, Metric)> {
    let [to_start, to_average] = stage.split(["start", "curvature"]);
    let (observed, prior) = (&problem.likelihood, &problem.prior);
    Ok(match variant {
        Variant::Paper | Variant::Best => {
            let (states, _) = importance_starts(observed, prior, chains, to_start)?;
            (states, Metric::Diagonal(curvature(observed, prior, CURVATURE_DRAWS, to_average)))
        }
        Variant::Dense => {
            let laplace = laplace(observed, prior, CURVATURE_DRAWS, problem.isa, to_average)?;
            let (states, _) = laplace_starts(&problem.target(), &laplace, chains, problem.isa, to_start)?;
            (states, Metric::Dense(laplace.metric))
        }
    })
}

/// Tunes a variant on one frame: step size for about 15 % rejection, length for the fewest gradients per effective draw.
pub(super) fn tune(problem: &Problem, variant: Variant, stage: Stage) -> Outcome<Step> {
    let [to_start, to_tune] = stage.split(["start", "tune"]);
    let (states, metric) = start(problem, variant, 16, to_start)?;
    let target = problem.target();
    let mut trial = StepSizeTrial { target: &target, metric: &metric, states, isa: problem.isa };
    let config = tuning::Config {
        jitter: variant.jitter(),
        lengths: variant.lengths(problem),
        updates: TUNING_UPDATES,
        ..tuning::Config::default()
    };
    let tuned = tuning::length(&mut trial, &config, &to_tune)?;
    Ok(Step { eta: tuned.step_size, steps: tuned.leapfrog_steps, acceptance: tuned.acceptance })
}

/// Runs `chains` chains for `updates` updates.
pub(super) fn run(
    problem: &Problem,
    variant: Variant,
    step: &Step,
    chains: usize,
    updates: usize,
    stage: Stage,
) -> Outcome<ChainDraws> {
    let [to_start, to_move] = stage.split(["start", "chains"]);
    let (states, metric) = start(problem, variant, chains, to_start)?;
    let hmc = Hmc::with_metric(step.eta, &metric, step.steps, variant.jitter(), problem.isa)?;
    Ok(draw_trajectories(&problem.target(), &hmc, &states, chains, Schedule { updates, burn_in: BURN_IN }, &to_move)?)
}

/// Mean of the kept draws.
pub(super) fn mean(draws: &ChainDraws) -> Vec<f64> {
    let count = draws.stats.len();
    moments::mean(&draws.states, draws.dim, &vec![1.0 / count as f64; count])
}

/// Likelihoods and gradients that a run takes.
pub(super) fn cost(step: &Step, chains: usize, updates: usize) -> (usize, usize) {
    (chains, chains * (1 + updates * step.steps) + CURVATURE_DRAWS)
}

/// Factor by which idle lanes make chains dearer.
pub(super) fn idle_lanes(chains: usize) -> f64 {
    (chains.div_ceil(LANES) * LANES) as f64 / chains as f64
}
