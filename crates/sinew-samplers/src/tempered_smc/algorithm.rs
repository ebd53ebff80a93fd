//! Adaptive tempered sequential Monte Carlo with Hamiltonian moves (Del Moral, Doucet & Jasra 2006).

use crate::Error;
use crate::chains::ChainStat;
use crate::hmc::kernel::{Chains, Hmc, Workspace, update};
use crate::metric::{Dense, Metric};
use crate::moments;
use crate::population::Population;
use crate::resample::systematic;
use crate::temperature::exponent;
use crate::weights::{effective_number, normalise};
use rayon::prelude::*;
use sinew_core::combinators::{Sum, Tempered};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::FramePrior;

/// Temperatures after which a run gives up.
pub const MOST_TEMPERATURES: usize = 1000;

/// Settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Particles N.
    pub particles: usize,
    /// Part α of them that stays effective from one temperature to the next.
    pub survival: f64,
    /// Updates K of each particle at each temperature.
    pub updates: usize,
    /// Step size η.
    pub step_size: f64,
    /// Leapfrog steps L.
    pub leapfrog_steps: usize,
    /// Jitter of the step size.
    pub jitter: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { particles: 256, survival: 0.5, updates: 4, step_size: 0.5, leapfrog_steps: 5, jitter: 0.2 }
    }
}

/// What happened at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Temperature {
    /// β.
    pub beta: f64,
    /// Effective number of the weights that led to it.
    pub effective: f64,
    /// Mean acceptance of its updates.
    pub acceptance: f64,
}

/// What a run leaves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// The population after each update at β = 1.
    pub draws: Vec<Population>,
    /// What is known of each of its states.
    pub stats: Vec<Vec<ChainStat>>,
    /// Logarithm of the evidence.
    pub log_evidence: f64,
    /// The temperatures, from the first above 0 to 1.
    pub temperatures: Vec<Temperature>,
    /// Divergent trajectories.
    pub divergences: usize,
    /// Evaluations of the likelihood without gradient.
    pub likelihoods: usize,
    /// Evaluations with gradient.
    pub gradients: usize,
}

impl Sample {
    /// Mean of the draws.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        let mut sum = vec![0.0; self.draws.first().map_or(0, Population::dim)];
        for draws in &self.draws {
            let weights = vec![1.0 / (draws.count() * self.draws.len()) as f64; draws.count()];
            let part = moments::mean(draws.states(), draws.dim(), &weights);
            sum.iter_mut().zip(part).for_each(|(sum, x)| *sum += x);
        }
        sum
    }
}

/// The metric (1 − β) P + β G.
fn metric_at<P: FramePrior>(prior: &P, posterior: &Metric, beta: f64) -> Result<Metric, Error> {
    let between = |p: &[f64], g: &[f64]| p.iter().zip(g).map(|(p, g)| (1.0 - beta) * p + beta * g).collect::<Vec<_>>();
    Ok(match posterior {
        Metric::Diagonal(h) => Metric::Diagonal(between(prior.precision_diagonal(), h)),
        Metric::Dense(dense) => Metric::Dense(Dense::new(&between(&prior.precision(), &dense.matrix()), prior.dim())?),
    })
}

/// A block's states after each update, and what is known of those in use.
struct Moved {
    states: Vec<Vec<Block>>,
    stats: Vec<Vec<ChainStat>>,
}

impl Moved {
    /// Sum of the acceptances.
    fn acceptance(&self) -> f64 {
        self.stats.iter().map(|stats| stats.iter().map(|stat| stat.acceptance).sum::<f64>()).sum()
    }
}

fn move_block<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    states: &[Block],
    used: usize,
    updates: usize,
    stage: &Stage,
    block: usize,
) -> Result<Moved, Error> {
    let mut rng = stage.block(block as u32);
    let mut chains = Chains::new(target, states.to_vec())?;
    let mut ws = Workspace::new(target);
    let mut moved = Moved { states: Vec::with_capacity(updates), stats: Vec::with_capacity(updates) };
    for _ in 0..updates {
        let info = update(target, hmc, &mut chains, &mut ws, &mut rng);
        moved.stats.push((0..used).map(|lane| info.stat(lane, chains.log_density.0[lane])).collect());
        moved.states.push(chains.position.clone());
    }
    Ok(moved)
}

/// Moves every block.
fn move_all<T: GradLogDensity + ?Sized>(
    target: &T,
    hmc: &Hmc,
    population: &Population,
    updates: usize,
    stage: &Stage,
) -> Result<Vec<Moved>, Error> {
    let blocks = population.states().par_chunks(population.dim()).enumerate();
    let moved = |(block, states): (usize, &[Block])| {
        let used = (population.count() - block * LANES).min(LANES);
        move_block(target, hmc, states, used, updates, stage, block)
    };
    blocks.map(moved).collect()
}

/// Runs from the prior to the posterior; `metric` is the posterior's.
///
/// # Errors
/// [`Error::Empty`], [`Error::OutOfRange`], [`Error::AllWeightsZero`], [`Error::BadWeight`], [`Error::BadStart`], [`Error::Metric`], [`Error::TooManyTemperatures`].
pub fn temper<O: GradLogDensity + ?Sized, P: FramePrior>(
    observed: &O,
    prior: &P,
    metric: &Metric,
    config: &Config,
    isa: Isa,
    stage: Stage,
) -> Result<Sample, Error> {
    let Config { particles, step_size, leapfrog_steps, jitter, .. } = *config;
    let [to_draw, to_resample, to_move] = stage.split(["draw", "resample", "move"]);
    let draw = |block: usize, states: &mut [Block]| {
        prior.sample_block(block, states, &mut to_draw.block(block as u32));
    };
    let population = Population::from_blocks(prior.dim(), particles, draw)?;
    let kernel = |beta: f64, _: &Population, _: Option<&Temperature>| {
        Hmc::with_metric(step_size, &metric_at(prior, metric, beta)?, leapfrog_steps, jitter, isa)
    };
    through_temperatures(observed, prior, population, config, kernel, [to_resample, to_move])
}

/// Takes a population of the prior to the posterior by the updates of `kernel`, which is told the exponent, the resampled population and what happened at the temperature before.
pub(super) fn through_temperatures<O: GradLogDensity + ?Sized, P: GradLogDensity + ?Sized>(
    observed: &O,
    prior: &P,
    mut population: Population,
    config: &Config,
    mut kernel: impl FnMut(f64, &Population, Option<&Temperature>) -> Result<Hmc, Error>,
    [to_resample, to_move]: [Stage; 2],
) -> Result<Sample, Error> {
    let (particles, updates) = (population.count(), config.updates);
    if updates == 0 {
        return Err(Error::OutOfRange { name: "number of updates", value: 0.0, expected: "must be at least 1" });
    }
    let mut values = population.log_densities(observed);
    let mut sample = Sample { likelihoods: particles, ..Sample::default() };
    let (mut beta, mut weights) = (0.0, Vec::new());
    loop {
        if sample.temperatures.len() == MOST_TEMPERATURES {
            return Err(Error::TooManyTemperatures { count: MOST_TEMPERATURES, beta });
        }
        let increment = exponent(&values, config.survival, 1.0 - beta)?;
        beta = if increment < 1.0 - beta { beta + increment } else { 1.0 };
        let tempered = |&l: &f64| if l == f64::NEG_INFINITY { l } else { increment * l };
        let log_weights: Vec<f64> = values.iter().map(tempered).collect();
        sample.log_evidence += normalise(&log_weights, &mut weights)? - (particles as f64).ln();
        let round = sample.temperatures.len();
        population = population.gather(&systematic(&weights, particles, &mut to_resample.round(round).whole()));

        let target = Sum(Tempered { target: observed, beta }, prior);
        let hmc = kernel(beta, &population, sample.temperatures.last())?;
        let moved = move_all(&target, &hmc, &population, updates, &to_move.round(round))?;
        sample.temperatures.push(Temperature {
            beta,
            effective: effective_number(&weights),
            acceptance: moved.iter().map(Moved::acceptance).sum::<f64>() / (particles * updates) as f64,
        });
        let divergent = |m: &Moved| m.stats.iter().flatten().filter(|stat| stat.divergent).count();
        sample.divergences += moved.iter().map(divergent).sum::<usize>();
        sample.gradients += particles * (1 + updates * hmc.leapfrog_steps());
        let after = |update: usize| population.with_blocks(moved.iter().map(|m| &m.states[update][..]));
        if beta >= 1.0 {
            sample.draws = (0..updates).map(after).collect();
            let stats = |update: usize| moved.iter().flat_map(|m| &m.stats[update]).copied().collect();
            sample.stats = (0..updates).map(stats).collect();
            return Ok(sample);
        }
        population = after(updates - 1);
        values = population.log_densities(observed);
        sample.likelihoods += particles;
    }
}
