//! Draws of a posterior and its evidence by tempered sequential Monte Carlo, in one call.

use super::algorithm::{Config, Sample, Temperature, through_temperatures};
use crate::Error;
use crate::chains::{ChainDraws, ChainStat};
use crate::density::{Density, OneByOne};
use crate::hmc::kernel::Hmc;
use crate::learned;
use crate::population::Population;
use crate::run::Run;
use sinew_core::combinators::{Sum, Tempered};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES, set_lane};
use sinew_core::random::{BlockRng, Stage};

/// A density that can be drawn from.
pub trait PriorDensity: Density {
    /// Draws one state.
    fn draw(&self, x: &mut [f64], rng: &mut BlockRng);
}

/// Independent normal coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalPrior {
    /// Means.
    pub mean: Vec<f64>,
    /// Standard deviations, as many.
    pub sd: Vec<f64>,
}

impl Density for NormalPrior {
    fn dim(&self) -> usize {
        self.mean.len()
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let mut value = 0.0;
        for (((g, x), mean), sd) in gradient.iter_mut().zip(x).zip(&self.mean).zip(&self.sd) {
            let z = (x - mean) / sd;
            *g = -z / sd;
            value -= 0.5 * z * z;
        }
        value
    }
}

impl PriorDensity for NormalPrior {
    fn draw(&self, x: &mut [f64], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; x.len().div_ceil(LANES)];
        rng.fill_normal(Isa::baseline(), &mut noise);
        let noise = noise.iter().flat_map(|block| block.0);
        x.iter_mut().zip(noise).zip(&self.mean).zip(&self.sd).for_each(|(((x, z), mean), sd)| *x = mean + sd * z);
    }
}

/// How [`sample`] runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Independent populations, the chains of the run: that they agree is what R̂ and effective sample sizes judge.
    pub populations: usize,
    /// Particles of one population.
    pub particles: usize,
    /// Updates of each particle at each temperature; those of the last one are all kept.
    pub updates: usize,
    /// The same seed gives the same draws, whatever the number of threads.
    pub seed: u64,
    /// Part of the particles that stays effective from one temperature to the next.
    pub survival: f64,
    /// Acceptance that the step size follows from temperature to temperature.
    pub acceptance: f64,
    /// Leapfrog steps of a trajectory.
    pub leapfrog_steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { populations: 4, particles: 256, updates: 4, seed: 0, survival: 0.5, acceptance: 0.8, leapfrog_steps: 5 }
    }
}

/// Samples the posterior of a prior and a likelihood, and estimates the evidence; modes that the prior reaches are all found.
///
/// The metric of each temperature is learned from the resampled population ([`crate::learned`]), and its step size follows the acceptance before. So an update keeps its target given the population, and estimates have a bias of order 1 / particles.
///
/// # Errors
/// [`Error::Empty`], [`Error::Length`] and [`Error::OutOfRange`] for settings; [`Error::AllWeightsZero`] where no particle explains the data, [`Error::Metric`], [`Error::TooManyTemperatures`].
pub fn sample(likelihood: &dyn Density, prior: &dyn PriorDensity, settings: Settings) -> Result<Run, Error> {
    let (d, names) = (prior.dim(), prior.names());
    for (what, found) in [("the likelihood's state", likelihood.dim()), ("the list of names", names.len())] {
        if found != d {
            return Err(Error::Length { what, found, expected: d });
        }
    }
    if settings.populations == 0 || d == 0 {
        return Err(Error::Empty { count: settings.populations, dim: d });
    }
    let mut run = Run { chains: settings.populations, step_size: f64::NAN, ..Run::default() };
    (run.names, run.leapfrog_steps) = (names, settings.leapfrog_steps);
    let root = Stage::new(settings.seed, "tempered sample");
    for population in 0..settings.populations {
        let sample = one_population(likelihood, prior, &settings, root.round(population))?;
        run.log_evidence.push(sample.log_evidence);
        // Particle after particle, so that those with one ancestor stand together.
        for i in 0..settings.particles {
            for (states, stats) in sample.draws.iter().zip(&sample.stats) {
                run.states.extend(states.state(i));
                run.stats.push(ChainStat { energy: f64::NAN, ..stats[i] });
            }
        }
    }
    Ok(run)
}

fn one_population(
    likelihood: &dyn Density,
    prior: &dyn PriorDensity,
    settings: &Settings,
    stage: Stage,
) -> Result<Sample, Error> {
    let Settings { particles, updates, survival, acceptance, leapfrog_steps, .. } = *settings;
    let isa = Isa::best();
    let [one_likelihood, one_prior] =
        [likelihood, prior as &dyn Density].map(|density| OneByOne { density, lanes: LANES });
    let observed: &dyn GradLogDensity = likelihood.by_blocks().unwrap_or(&one_likelihood);
    let before: &dyn GradLogDensity = prior.by_blocks().unwrap_or(&one_prior);
    let [to_draw, to_resample, to_move] = stage.split(["draw", "resample", "move"]);
    let draw = |block: usize, states: &mut [Block]| {
        let (mut rng, mut x) = (to_draw.block(block as u32), vec![0.0; states.len()]);
        for lane in 0..LANES {
            prior.draw(&mut x, &mut rng);
            set_lane(states, lane, &x);
        }
    };
    let population = Population::from_blocks(prior.dim(), particles, draw)?;
    let mut step_size = 0.5;
    let kernel = |beta: f64, population: &Population, last: Option<&Temperature>| {
        if let Some(last) = last {
            step_size *= (last.acceptance - acceptance).exp();
        }
        let draws = ChainDraws {
            dim: population.dim(),
            chains: 1,
            states: population.states().to_vec(),
            stats: vec![ChainStat::default(); population.count()],
            ..ChainDraws::default()
        };
        let target = Sum(Tempered { target: observed, beta }, before);
        let metric = learned::metric(&target, &draws, survival * particles as f64, isa)?;
        Hmc::with_metric(step_size, &metric, leapfrog_steps, 0.2, isa)
    };
    let config = Config { survival, updates, ..Config::default() };
    through_temperatures(observed, before, population, &config, kernel, [to_resample, to_move])
}
