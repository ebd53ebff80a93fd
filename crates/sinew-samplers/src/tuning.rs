//! Step size and trajectory length of Hamiltonian Monte Carlo by trial.
//!
//! Both are found before any draw is kept, and are then fixed (Choo & Fleet 2001):
//!
//! - η: the acceptance probability falls with η. It is halved or doubled from a first guess until the target acceptance is bracketed (at most 50 times, then an error), then log η is bisected, with some 200 trajectories an
//!   evaluation, until the acceptance is within the tolerance. The chains continue from evaluation to evaluation and so reach the target's bulk on the way.
//! - L: for each candidate η is found as above, chains run, and the L with the least cost per effective draw, τ L, wins (τ: the largest over coordinates of the integrated autocorrelation time).
//! - [`cheapest`] does so for several acceptance targets, and the pair of η and L with the least cost wins: where a metric fits, longer steps pay although more of them are rejected.
//! - [`no_u_turn`] is the same for the no-U-turn sampler, whose trees choose the length.

use crate::Error;
use crate::chains::{ChainDraws, Schedule, draw_trajectories};
use crate::hmc::Hmc;
use crate::metric::Metric;
use crate::nuts::{self, Nuts};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;

/// Halvings or doublings of the step size before the search gives up.
pub const MOST_HALVINGS: usize = 50;
/// Bisections of log η: the bracket is then narrower than the noise.
const BISECTIONS: usize = 20;

/// Settings; the default aims at the paper's 15 % of rejections.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Acceptance probability to aim at.
    pub acceptance: f64,
    /// Allowed deviation from it.
    pub tolerance: f64,
    /// Trajectories of one evaluation of the acceptance (rounded up over all lanes).
    pub trajectories: usize,
    /// First guess of η.
    pub first_step_size: f64,
    /// Trajectory lengths L to compare.
    pub lengths: Vec<usize>,
    /// Updates a chain for the comparison.
    pub updates: usize,
    /// Jitter in use.
    pub jitter: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            acceptance: 0.85,
            tolerance: 0.03,
            trajectories: 200,
            first_step_size: 0.5,
            lengths: vec![1, 2, 5, 10, 20, 40, 80],
            updates: 100,
            jitter: 0.0,
        }
    }
}

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// η.
    pub step_size: f64,
    /// L.
    pub leapfrog_steps: usize,
    /// Acceptance probability found there.
    pub acceptance: f64,
    /// Gradients per effective draw, τ L; NaN where it was not measured.
    pub gradients_per_draw: f64,
}

/// A target with the chains that try step sizes on it.
pub struct StepSizeTrial<'a, T: ?Sized> {
    /// The target.
    pub target: &'a T,
    /// Metric of the trajectories.
    pub metric: &'a Metric,
    /// Where the chains stand: blocks of the target's dimension, every lane in use.
    pub states: Vec<Block>,
    /// Instruction set.
    pub isa: Isa,
}

impl<T: GradLogDensity + ?Sized> StepSizeTrial<'_, T> {
    fn chains(&self) -> usize {
        self.states.len() / self.target.dim().max(1) * LANES
    }

    fn run(&mut self, eta: f64, steps: usize, jitter: f64, updates: usize, stage: &Stage) -> Result<ChainDraws, Error> {
        let hmc = Hmc::with_metric(eta, self.metric, steps, jitter, self.isa)?;
        let schedule = Schedule { updates, burn_in: 1.min(updates) };
        let draws = draw_trajectories(self.target, &hmc, &self.states, self.chains(), schedule, stage)?;
        self.states.clone_from(&draws.last);
        Ok(draws)
    }
}

/// The step size for trajectories of `steps` leapfrog steps.
///
/// # Errors
/// [`Error::StepSizeNotFound`], [`Error::BadStart`], [`Error::OutOfRange`].
pub fn step_size<T: GradLogDensity + ?Sized>(
    trial: &mut StepSizeTrial<'_, T>,
    steps: usize,
    config: &Config,
    stage: &Stage,
) -> Result<Tuned, Error> {
    let updates = config.trajectories.div_ceil(trial.chains().max(1));
    let mut round = 0;
    let (step_size, acceptance) = search(config, |eta| {
        round += 1;
        Ok(trial.run(eta, steps, config.jitter, updates, &stage.round(round))?.acceptance)
    })?;
    Ok(Tuned { step_size, leapfrog_steps: steps, acceptance, gradients_per_draw: f64::NAN })
}

/// The step size whose acceptance is within the tolerance, and that acceptance.
fn search(config: &Config, mut acceptance: impl FnMut(f64) -> Result<f64, Error>) -> Result<(f64, f64), Error> {
    let mut eta = config.first_step_size;
    let mut rate = acceptance(eta)?;
    let grow = rate > config.acceptance;
    let factor = if grow { 2.0 } else { 0.5 };
    let mut tried = 0;
    while (rate > config.acceptance) == grow {
        if (rate - config.acceptance).abs() <= config.tolerance {
            return Ok((eta, rate));
        }
        if tried == MOST_HALVINGS {
            let (target, step_size) = (config.acceptance, eta);
            return Err(Error::StepSizeNotFound { target, step_size, acceptance: rate, tried });
        }
        tried += 1;
        eta *= factor;
        rate = acceptance(eta)?;
    }
    let (mut low, mut high) = if grow { (eta / 2.0, eta) } else { (eta, 2.0 * eta) };
    for _ in 0..BISECTIONS {
        eta = (low * high).sqrt();
        rate = acceptance(eta)?;
        if (rate - config.acceptance).abs() <= config.tolerance {
            break;
        }
        if rate > config.acceptance { low = eta } else { high = eta }
    }
    Ok((eta, rate))
}

/// Step size and length with the fewest gradients per effective draw.
///
/// # Errors
/// As [`step_size`]; [`Error::OutOfRange`] without candidates.
pub fn length<T: GradLogDensity + ?Sized>(
    trial: &mut StepSizeTrial<'_, T>,
    config: &Config,
    stage: &Stage,
) -> Result<Tuned, Error> {
    least(&config.lengths, |i, steps| {
        let stage = stage.round(i);
        let tuned = step_size(trial, steps, config, &stage)?;
        let draws = trial.run(tuned.step_size, steps, config.jitter, config.updates, &stage.round(0))?;
        let gradients_per_draw = (draws.stats.len() * steps) as f64 / draws.least_effective();
        Ok(Tuned { gradients_per_draw, ..tuned })
    })
}

/// Step size and length with the fewest gradients per effective draw, for any of the `acceptances` in place of the configured one.
///
/// # Errors
/// As [`length`]; [`Error::OutOfRange`] without candidates.
pub fn cheapest<T: GradLogDensity + ?Sized>(
    trial: &mut StepSizeTrial<'_, T>,
    config: &Config,
    acceptances: &[f64],
    stage: &Stage,
) -> Result<Tuned, Error> {
    least(acceptances, |i, acceptance| length(trial, &Config { acceptance, ..config.clone() }, &stage.round(i)))
}

/// Step size of the no-U-turn sampler with the fewest gradients per effective draw, for any of the `acceptances`. The length found is the mean number of leapfrog steps of a transition, rounded;
/// the configured lengths are not used.
///
/// # Errors
/// As [`cheapest`].
pub fn no_u_turn<T: GradLogDensity + ?Sized>(
    trial: &mut StepSizeTrial<'_, T>,
    config: &Config,
    max_depth: usize,
    acceptances: &[f64],
    stage: &Stage,
) -> Result<Tuned, Error> {
    let chains = trial.chains().max(1);
    let mut run = |eta: f64, updates: usize, stage: &Stage| {
        let nuts = Nuts::with_metric(eta, trial.metric, max_depth, config.jitter, trial.isa)?;
        let schedule = Schedule { updates, burn_in: 1.min(updates) };
        let run = nuts::draw_trees(trial.target, &nuts, &trial.states, trial.chains(), schedule, stage)?;
        trial.states.clone_from(&run.draws.last);
        Ok::<_, Error>(run)
    };
    least(acceptances, |i, acceptance| {
        let (stage, mut round) = (stage.round(i), 0);
        let (step_size, acceptance) = search(&Config { acceptance, ..config.clone() }, |eta| {
            round += 1;
            Ok(run(eta, config.trajectories.div_ceil(chains), &stage.round(round))?.draws.acceptance)
        })?;
        let run = run(step_size, config.updates, &stage.round(0))?;
        let gradients_per_draw = run.leapfrog_steps as f64 / run.draws.least_effective();
        let leapfrog_steps = (run.leapfrog_steps + run.draws.stats.len() / 2) / run.draws.stats.len().max(1);
        Ok(Tuned { step_size, leapfrog_steps, acceptance, gradients_per_draw })
    })
}

/// The cheapest of what the candidates lead to.
fn least<C: Copy>(candidates: &[C], mut tuned: impl FnMut(usize, C) -> Result<Tuned, Error>) -> Result<Tuned, Error> {
    let mut best: Option<Tuned> = None;
    for (i, &candidate) in candidates.iter().enumerate() {
        let tuned = tuned(i, candidate)?;
        if best.is_none_or(|b| tuned.gradients_per_draw < b.gradients_per_draw) {
            best = Some(tuned);
        }
    }
    best.ok_or(Error::OutOfRange { name: "number of candidates", value: 0.0, expected: "must be at least 1" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{Lanes, LogDensity};
    use sinew_core::toy::Quadratic;

    /// A target that no trajectory survives: log density falls without end at any step.
    struct Spike;
    impl LogDensity for Spike {
        fn dim(&self) -> usize {
            1
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            if x[0] == 0.0 { 0.0 } else { f64::NEG_INFINITY }
        }
    }
    impl GradLogDensity for Spike {
        fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
            grad[0] = 1.0;
            self.log_density(x)
        }
    }

    #[test]
    fn acceptance_is_reached_and_a_length_chosen() {
        let precision: Vec<f64> = (0..10).map(|j| 1.0 + 3.0 * f64::from(j)).collect();
        let isa = Isa::best();
        let target = Lanes { leaf: Quadratic { centre: vec![0.0; 10], precision }, isa };
        // A curvature of 1 leaves a condition number of 28.
        let mut trial = StepSizeTrial {
            target: &target,
            metric: &Metric::Diagonal(vec![1.0; 10]),
            states: vec![Block::splat(0.1); 20],
            isa,
        };
        let config = Config { jitter: 0.2, lengths: vec![1, 5, 10, 80], ..Config::default() };
        let tuned = length(&mut trial, &config, &Stage::new(4, "tune")).expect("tunable");
        assert!((tuned.acceptance - 0.85).abs() <= 0.03, "{tuned:?}");
        assert!([5, 10].contains(&tuned.leapfrog_steps), "{tuned:?}");
        let again = trial.run(tuned.step_size, tuned.leapfrog_steps, 0.2, 200, &Stage::new(5, "check"));
        assert!((again.expect("valid").acceptance - 0.85).abs() < 0.06);
    }

    #[test]
    fn steps_and_trees_are_chosen_by_cost() {
        let isa = Isa::best();
        let target = Lanes { leaf: Quadratic { centre: vec![0.0; 10], precision: vec![1.0; 10] }, isa };
        let metric = Metric::Diagonal(vec![1.0; 10]);
        let mut trial = StepSizeTrial { target: &target, metric: &metric, states: vec![Block::splat(0.1); 10], isa };
        let config = Config { jitter: 0.2, lengths: vec![1, 2, 30], updates: 300, ..Config::default() };
        // Neither is the configuration's own.
        let acceptances = [0.99, 0.75];
        let hmc = cheapest(&mut trial, &config, &acceptances, &Stage::new(1, "cheapest")).expect("tunable");
        assert!(hmc.leapfrog_steps < 30 && (hmc.acceptance - 0.75).abs() <= 0.03, "{hmc:?}");
        let nuts = no_u_turn(&mut trial, &config, 10, &acceptances, &Stage::new(1, "trees")).expect("tunable");
        assert!((nuts.acceptance - 0.75).abs() <= 0.03 && (2..8).contains(&nuts.leapfrog_steps), "{nuts:?}");
        assert!(nuts.gradients_per_draw > hmc.gradients_per_draw && nuts.gradients_per_draw < 20.0, "{nuts:?}");
        let again = no_u_turn(&mut trial, &config, 10, &[], &Stage::new(1, "none"));
        assert!(matches!(again, Err(Error::OutOfRange { name: "number of candidates", .. })));
    }

    /// A rate of 1 / (1 + η²): found from either side, to the tolerance, within the interval that doubling or halving has enclosed.
    #[test]
    fn searches_enclose_and_halve() {
        let searched = |first_step_size: f64, tolerance: f64| {
            let config = Config { first_step_size, tolerance, acceptance: 0.8, ..Config::default() };
            let mut tried = vec![];
            let found = search(&config, |eta| {
                tried.push(eta);
                Ok(1.0 / (1.0 + eta * eta))
            });
            (found.expect("there is one"), tried)
        };
        for (first, enclosed) in
            [(1.0, vec![1.0, 0.5]), (0.2, vec![0.2, 0.4, 0.8]), (6.0, vec![6.0, 3.0, 1.5, 0.75, 0.375])]
        {
            let ((eta, rate), tried) = searched(first, 1e-6);
            assert!((eta - 0.5).abs() < 2e-6 && (rate - 0.8).abs() <= 1e-6, "{eta} {rate}");
            assert_eq!(tried[..enclosed.len()], enclosed);
            let (low, high) = (enclosed[enclosed.len() - 2], enclosed[enclosed.len() - 1]);
            let inside = |eta: &&f64| (low.min(high)..=low.max(high)).contains(*eta);
            assert_eq!(tried.iter().skip(enclosed.len()).filter(inside).count(), tried.len() - enclosed.len());
            if let Some(third) = tried.get(enclosed.len()) {
                assert!((third - (low * high).sqrt()).abs() < 1e-15);
            }
        }
        // The first one that is near enough ends the search.
        assert_eq!(searched(0.45, 0.05).1, [0.45]);
    }

    #[test]
    fn a_search_without_end_is_an_error() {
        let isa = Isa::best();
        let mut trial =
            StepSizeTrial { target: &Spike, metric: &Metric::Diagonal(vec![1.0]), states: vec![Block::ZERO], isa };
        let error = step_size(&mut trial, 2, &Config::default(), &Stage::new(1, "spike"));
        assert!(matches!(error, Err(Error::StepSizeNotFound { tried: 50, acceptance: 0.0, .. })), "{error:?}");
        let flat = Lanes { leaf: Quadratic { centre: vec![0.0], precision: vec![0.0] }, isa };
        let mut trial =
            StepSizeTrial { target: &flat, metric: &Metric::Diagonal(vec![1.0]), states: vec![Block::ZERO], isa };
        let error = step_size(&mut trial, 2, &Config::default(), &Stage::new(1, "flat"));
        assert!(matches!(error, Err(Error::StepSizeNotFound { tried: 50, .. })), "{error:?}");
        assert!(length(&mut trial, &Config { lengths: vec![], ..Config::default() }, &Stage::new(1, "none")).is_err());
    }
}
