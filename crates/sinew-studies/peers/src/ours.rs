//! Our samplers: Hamiltonian and no-U-turn, each with three metrics, tuned by cost per effective draw.

use crate::measure::{Clock, Run};
use crate::problem::Problem;
use sinew::core::diagnostics::effective_sample_size;
use sinew::core::lanes::{Block, LANES};
use sinew::core::random::Stage;
use sinew::samplers::chains::{self, ChainDraws, Schedule};
use sinew::samplers::curvature::curvature;
use sinew::samplers::gaussian_mixture::GaussianMixture;
use sinew::samplers::hmc::Hmc;
use sinew::samplers::jumps::{self, Jumps};
use sinew::samplers::laplace::laplace;
use sinew::samplers::learned;
use sinew::samplers::metric::Metric;
use sinew::samplers::nuts::{self, MAX_DEPTH, Nuts};
use sinew::samplers::starts::{importance_starts, laplace_starts};
use sinew::samplers::tuning::{self, StepSizeTrial, Tuned};
use std::error::Error;

/// Kept draws of all chains together.
const DRAWS: usize = 64_000;
/// Transitions of every chain before the first kept draw, after tuning.
const BURN_IN: usize = 50;
/// Draws of the prior for curvature and mode.
const PRIOR_DRAWS: usize = 64;
/// Draws a chain from which a metric is learned, twice.
const LEARNING: usize = 250;
const JITTER: f64 = 0.2;
/// Leapfrog steps of a trajectory between jumps, jumps after each, components of their proposal, and draws a chain that it is fitted to, twice. Between 3 and 6 steps, 2 and 8 jumps, and 2 and 8
/// components the effective draws a second differ by up to a half.
const BETWEEN_JUMPS: usize = 4;
const JUMPS: usize = 4;
const COMPONENTS: usize = 2;
const FITTING: usize = 500;

/// How chains move.
#[derive(Clone, Copy, PartialEq)]
pub enum Method {
    /// Hamiltonian Monte Carlo with a fixed length.
    Hmc,
    /// No-U-turn sampler.
    Nuts,
    /// Hamiltonian Monte Carlo with jumps after each trajectory.
    Jumps,
}

impl Method {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Hmc, Self::Nuts, Self::Jumps];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hmc => "HMC",
            Self::Nuts => "NUTS",
            Self::Jumps => "HMC with jumps",
        }
    }
}

/// In which metric.
#[derive(Clone, Copy, PartialEq)]
pub enum Choice {
    /// Gauss–Newton diagonal averaged over the prior.
    Diagonal,
    /// Whole Gauss–Newton matrix around the mode.
    GaussNewton,
    /// Geometric mean of the draws' precision and their gradients' covariance.
    Learned,
}

impl Choice {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Diagonal, Self::GaussNewton, Self::Learned];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Diagonal => "diagonal metric",
            Self::GaussNewton => "dense metric, Gauss–Newton",
            Self::Learned => "dense metric, learned",
        }
    }

    fn config(self) -> tuning::Config {
        let lengths = match self {
            Self::Diagonal => vec![20, 30, 40],
            Self::GaussNewton => vec![6, 8, 10, 12],
            Self::Learned => vec![4, 5, 6, 7, 8, 10],
        };
        tuning::Config { lengths, updates: 400, jitter: JITTER, ..tuning::Config::default() }
    }
}

/// Acceptance probabilities among which tuning chooses.
const ACCEPTANCES: [f64; 3] = [0.75, 0.84, 0.92];

/// Metric and starts of eight chains.
fn prepared(problem: &Problem, choice: Choice, seed: u64) -> Result<(Metric, Vec<Block>), Box<dyn Error>> {
    let [to_find, to_start, to_learn] = Stage::new(seed, "peers").split(["find", "start", "learn"]);
    let (likelihood, prior, isa) = (&problem.likelihood, &problem.prior, problem.isa);
    if choice == Choice::Diagonal {
        let (starts, _) = importance_starts(likelihood, prior, LANES, to_start)?;
        return Ok((Metric::Diagonal(curvature(likelihood, prior, PRIOR_DRAWS, to_find)), starts));
    }
    let found = laplace(likelihood, prior, PRIOR_DRAWS, isa, to_find)?;
    let (mut states, _) = laplace_starts(&problem.target(), &found, LANES, isa, to_start)?;
    let mut metric = Metric::Dense(found.metric);
    if choice == Choice::Learned {
        let target = problem.target();
        let config = choice.config();
        for round in 0..2 {
            let stage = to_learn.round(round);
            let mut trial = StepSizeTrial { target: &target, metric: &metric, states, isa };
            let tuned = tuning::step_size(&mut trial, 8, &config, &stage.round(0))?;
            let hmc = Hmc::with_metric(tuned.step_size, &metric, 8, JITTER, isa)?;
            let schedule = Schedule { updates: LEARNING * (round + 1), burn_in: BURN_IN };
            let draws = chains::draw_trajectories(&target, &hmc, &trial.states, LANES, schedule, &stage.round(1))?;
            metric = learned::metric(&target, &draws, effective(&draws), isa)?;
            states = draws.last;
        }
    }
    Ok((metric, states))
}

fn tuned(
    problem: &Problem,
    method: Method,
    choice: Choice,
    metric: &Metric,
    states: Vec<Block>,
    stage: &Stage,
) -> Result<(Tuned, Vec<Block>), Box<dyn Error>> {
    let target = problem.target();
    let mut trial = StepSizeTrial { target: &target, metric, states, isa: problem.isa };
    let config = choice.config();
    let tuned = match method {
        Method::Hmc => tuning::cheapest(&mut trial, &config, &ACCEPTANCES, stage)?,
        Method::Jumps => tuning::step_size(&mut trial, BETWEEN_JUMPS, &config, stage)?,
        Method::Nuts => tuning::no_u_turn(&mut trial, &config, MAX_DEPTH, &ACCEPTANCES, stage)?,
    };
    Ok((tuned, trial.states))
}

/// What a kind of chain makes of a schedule.
struct Drawn {
    draws: ChainDraws,
    gradients: usize,
    depth: Option<f64>,
}

/// Warm-up with eight chains, then the draws with `chains` of them.
pub fn run(problem: &Problem, method: Method, choice: Choice, chains: usize, seed: u64) -> Result<Run, Box<dyn Error>> {
    let [to_tune, to_burn, to_draw] = Stage::new(seed, "peers run").split(["tune", "burn in", "draw"]);
    let target = problem.target();
    let start = Clock::start();
    let (metric, states) = prepared(problem, choice, seed)?;
    let (tuned, states) = tuned(problem, method, choice, &metric, states, &to_tune)?;
    let hmc = Hmc::with_metric(tuned.step_size, &metric, tuned.leapfrog_steps, JITTER, problem.isa)?;
    let nuts = Nuts::with_metric(tuned.step_size, &metric, MAX_DEPTH, JITTER, problem.isa)?;
    let (jumps, states) = match method {
        Method::Jumps => {
            let (proposal, states) = learned_proposal(problem, &hmc, states, &to_burn)?;
            // One chain alone has the proposals of all lanes.
            (Some(Jumps { proposal, count: if chains == 1 { 1 } else { JUMPS } }), states)
        }
        Method::Hmc | Method::Nuts => (None, states),
    };
    let draw = |states: &[Block], updates: usize, stage: &Stage| -> Result<Drawn, Box<dyn Error>> {
        let schedule = Schedule { updates, burn_in: 1 };
        let steps = chains * updates * tuned.leapfrog_steps;
        Ok(match (&jumps, method) {
            (Some(jumps), _) => {
                let run = jumps::draw_with_jumps(&target, &hmc, jumps, states, chains, schedule, stage)?;
                let proposals = chains.div_ceil(LANES) * LANES * updates * jumps.count;
                Drawn { draws: run.draws, gradients: steps + proposals, depth: None }
            }
            (None, Method::Nuts) => {
                let run = nuts::draw_trees(&target, &nuts, states, chains, schedule, stage)?;
                Drawn { depth: Some(run.mean_depth()), gradients: run.leapfrog_steps, draws: run.draws }
            }
            (None, _) => {
                let draws = chains::draw_trajectories(&target, &hmc, states, chains, schedule, stage)?;
                Drawn { draws, gradients: steps, depth: None }
            }
        })
    };
    let burnt = draw(&states, BURN_IN, &to_burn.round(0))?.draws.last;
    let before = start.seconds();
    // One chain alone makes fewer draws, since each costs it as much as eight chains' do.
    let updates = DRAWS / chains.max(4);
    let start = Clock::start();
    let Drawn { draws, gradients, depth } = draw(&burnt, updates, &to_draw)?;
    let seconds = [before, start.seconds()];
    Ok(Run {
        series: (0..28).map(|j| draws.series(j)).collect(),
        seconds,
        gradients: [0, gradients],
        acceptance: Some(draws.acceptance),
        length: gradients as f64 / (chains * updates) as f64,
        depth,
        divergences: draws.divergences,
    })
}

/// The proposal: a mixture fitted to plain trajectories, then once more to the draws that jumps from that one give.
fn learned_proposal(
    problem: &Problem,
    hmc: &Hmc,
    states: Vec<Block>,
    stage: &Stage,
) -> Result<(GaussianMixture, Vec<Block>), Box<dyn Error>> {
    let target = problem.target();
    let schedule = Schedule { updates: FITTING, burn_in: 1 };
    let fit = |draws: &ChainDraws| {
        let blocks = draws.stats.len() / LANES;
        GaussianMixture::fit(problem.isa, &draws.states[..blocks * 28], 28, COMPONENTS, effective(draws))
    };
    let draws = chains::draw_trajectories(&target, hmc, &states, LANES, schedule, &stage.round(1))?;
    let rough = Jumps { proposal: fit(&draws)?, count: JUMPS };
    let run = jumps::draw_with_jumps(&target, hmc, &rough, &draws.last, LANES, schedule, &stage.round(2))?;
    Ok((fit(&run.draws)?, run.draws.last))
}

/// Effective number of draws, the mean over coordinates.
fn effective(draws: &ChainDraws) -> f64 {
    (0..28).map(|j| effective_sample_size(&draws.series(j))).sum::<f64>() / 28.0
}
