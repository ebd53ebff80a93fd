//! No-U-turn and Hamiltonian chains on a log density written in Python.

use crate::arrays::{affordable, array, numbers};
use crate::background::interruptible;
use crate::failure::{Failure, USAGE};
use crate::log_density::PythonDensity;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use sinew::core::lanes::{Block, Isa, LANES, set_lane};
use sinew::core::random::Stage;
use sinew::samplers::Error;
use sinew::samplers::chains::{self, ChainDraws, Schedule};
use sinew::samplers::hmc::Hmc;
use sinew::samplers::nuts::{self, Nuts};
use sinew::samplers::warm_up::{Config, warm_up};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Jitter of the step size of Hamiltonian trajectories of fixed length.
const JITTER: f64 = 0.2;

/// Draws of several chains.
///
/// Attributes
/// ----------
/// draws
///     (chains, draws, dim), in the units of the state.
/// lp
///     (chains, draws), log density of each draw.
/// acceptance_rate, energy
///     (chains, draws), probability with which the trajectory was accepted, and Hamiltonian.
/// diverging
///     (chains, draws), whether the trajectory diverged.
/// step_size
///     Step size of the trajectories, in units of the learned metric.
#[pyclass(frozen, get_all, name = "ChainDraws", module = "sinew")]
pub(crate) struct PyChainDraws {
    draws: Py<PyArrayDyn<f64>>,
    lp: Py<PyArrayDyn<f64>>,
    acceptance_rate: Py<PyArrayDyn<f64>>,
    energy: Py<PyArrayDyn<f64>>,
    diverging: Py<PyArrayDyn<bool>>,
    step_size: f64,
}

#[pymethods]
impl PyChainDraws {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("ChainDraws(draws {}, step size {:.3})", self.draws.bind(py).getattr("shape")?, self.step_size))
    }
}

/// Which trajectories.
#[derive(Clone, Copy)]
enum Trajectories {
    NoUTurn { max_depth: usize },
    Fixed { leapfrog_steps: usize },
}

/// The no-U-turn sampler on a log density written in Python.
///
/// The slow path: every eight states cost a call of Python under the interpreter's lock. A warm-up climbs into the bulk, learns a metric and a step size (as Stan does), and is thrown away.
///
/// Parameters
/// ----------
/// log_density
///     Function of states (n, dim) that returns log densities (n,) and gradients (n, dim). -inf is a state that cannot be; NaN counts as such.
/// starts
///     (chains, dim), states of finite log density.
/// draws
///     Draws that are kept of each chain.
/// warm_up
///     Transitions of each chain that learn metric and step size.
/// acceptance
///     Acceptance that the step size aims at.
/// max_depth
///     Greatest depth of a tree.
/// seed
///     The same seed gives the same draws, whatever the number of threads.
#[pyfunction]
#[pyo3(name = "nuts", signature = (log_density, starts, *, draws = 1000, warm_up = 850, acceptance = 0.8, max_depth = 10, seed = 0))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn no_u_turn(
    py: Python<'_>,
    log_density: Py<PyAny>,
    starts: &Bound<'_, PyAny>,
    draws: usize,
    warm_up: usize,
    acceptance: f64,
    max_depth: usize,
    seed: u64,
) -> PyResult<PyChainDraws> {
    let plan = Plan { draws, warm_up, acceptance, seed, trajectories: Trajectories::NoUTurn { max_depth } };
    sample(py, &log_density, starts, plan)
}

/// Hamiltonian Monte Carlo with trajectories of fixed length on a log density written in Python.
///
/// The slow path, as `nuts` is. Metric and step size come from the same warm-up.
///
/// Parameters
/// ----------
/// log_density, starts, draws, warm_up, acceptance, seed
///     As in `nuts`.
/// leapfrog_steps
///     Leapfrog steps of a trajectory.
#[pyfunction]
#[pyo3(name = "hmc", signature = (log_density, starts, *, draws = 1000, warm_up = 850, acceptance = 0.8, leapfrog_steps = 8, seed = 0))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn hamiltonian(
    py: Python<'_>,
    log_density: Py<PyAny>,
    starts: &Bound<'_, PyAny>,
    draws: usize,
    warm_up: usize,
    acceptance: f64,
    leapfrog_steps: usize,
    seed: u64,
) -> PyResult<PyChainDraws> {
    let plan = Plan { draws, warm_up, acceptance, seed, trajectories: Trajectories::Fixed { leapfrog_steps } };
    sample(py, &log_density, starts, plan)
}

/// How to sample.
struct Plan {
    draws: usize,
    warm_up: usize,
    acceptance: f64,
    seed: u64,
    trajectories: Trajectories,
}

impl Plan {
    fn check(&self) -> Result<(), Failure> {
        let refused = |what: String| Failure { code: USAGE, ..Failure::argument(what) };
        if self.draws == 0 || self.warm_up < LEAST_WARM_UP {
            return Err(refused(format!(
                "`draws` is {} and `warm_up` is {}; at least 1 and {LEAST_WARM_UP} are needed",
                self.draws, self.warm_up
            )));
        }
        if !(self.acceptance > 0.0 && self.acceptance < 1.0) {
            return Err(refused(format!("`acceptance` is {}; it must be between 0 and 1", self.acceptance)));
        }
        Ok(())
    }

    /// Windows that double, the last one for the step size alone.
    fn windows(&self) -> Config {
        let part = self.warm_up / 17;
        let windows = vec![part, 2 * part, 4 * part, 8 * part];
        let last_window = self.warm_up - windows.iter().sum::<usize>();
        let max_depth = match self.trajectories {
            Trajectories::NoUTurn { max_depth } => max_depth,
            Trajectories::Fixed { .. } => nuts::MAX_DEPTH,
        };
        Config { windows, last_window, acceptance: self.acceptance, max_depth, ..Config::default() }
    }

    fn run(&self, target: &PythonDensity<'_>, starts: &[Block], chains: usize) -> Result<(ChainDraws, f64), Error> {
        let isa = Isa::best();
        let stage = Stage::new(self.seed, "chains of a Python density");
        let [warming, drawing] = stage.split(["warm-up", "draws"]);
        let warm = warm_up(target, starts, chains, &self.windows(), isa, &warming)?;
        let schedule = Schedule { updates: self.draws, burn_in: 1 };
        let draws = match self.trajectories {
            Trajectories::NoUTurn { max_depth } => {
                let kernel = Nuts::with_metric(warm.step_size, &warm.metric, max_depth, 0.0, isa)?;
                nuts::draw(target, &kernel, &warm.states, chains, schedule, &drawing)?.draws
            }
            Trajectories::Fixed { leapfrog_steps } => {
                let kernel = Hmc::with_metric(warm.step_size, &warm.metric, leapfrog_steps, JITTER, isa)?;
                chains::draw(target, &kernel, &warm.states, chains, schedule, &drawing)?
            }
        };
        Ok((draws, warm.step_size))
    }
}

/// Transitions without which no metric is learned.
const LEAST_WARM_UP: usize = 170;

fn sample(py: Python<'_>, function: &Py<PyAny>, starts: &Bound<'_, PyAny>, plan: Plan) -> PyResult<PyChainDraws> {
    plan.check()?;
    let starts = numbers("starts", starts)?;
    let shape = starts.exactly(&[("chains", None), ("dim", None)])?;
    let (chains, dim) = (shape[0], shape[1]);
    if chains == 0 || dim == 0 {
        return Err(Failure::argument("`starts` is empty; give one row a chain").into());
    }
    // The draws twice, and what is known of each.
    affordable(&[plan.draws.max(plan.warm_up), chains, 2 * dim + 10])?;
    let blocks = blocks(starts.finite()?, dim);
    let mut raised = None;
    let stop = Arc::new(AtomicBool::new(false));
    let outcome = interruptible(
        py,
        &stop,
        |_| Ok(()),
        || {
            let target = PythonDensity::new(function, dim, &stop);
            let found = plan.run(&target, &blocks, chains);
            raised = target.raised();
            if stop.load(Ordering::Relaxed) { Ok(None) } else { Ok(Some(found)) }
        },
    )?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    match outcome {
        Some(found) => {
            let (draws, step_size) = found.map_err(Failure::from)?;
            gathered(py, &draws, step_size)
        }
        None => Err(Failure::bug("stopped without a signal").into()),
    }
}

/// Starts in blocks of eight; idle lanes repeat the last one.
fn blocks(starts: &[f64], dim: usize) -> Vec<Block> {
    let chains = starts.len() / dim;
    let mut blocks = vec![Block::ZERO; chains.div_ceil(LANES) * dim];
    for lane in 0..chains.div_ceil(LANES) * LANES {
        let start = &starts[lane.min(chains - 1) * dim..][..dim];
        set_lane(&mut blocks[lane / LANES * dim..][..dim], lane % LANES, start);
    }
    blocks
}

fn gathered(py: Python<'_>, draws: &ChainDraws, step_size: f64) -> PyResult<PyChainDraws> {
    let (chains, dim) = (draws.chains, draws.dim);
    let each = draws.stats.len() / chains;
    let mut states = vec![0.0; chains * each * dim];
    for coordinate in 0..dim {
        for (chain, series) in draws.series(coordinate).into_iter().enumerate() {
            let places = states[chain * each * dim + coordinate..].iter_mut().step_by(dim);
            places.zip(series).for_each(|(place, x)| *place = x);
        }
    }
    let by_chain = || (0..chains).flat_map(|chain| draws.stats.iter().skip(chain).step_by(chains));
    let shape = [chains, each];
    Ok(PyChainDraws {
        draws: array(py, [chains, each, dim], states)?.unbind(),
        lp: array(py, shape, by_chain().map(|stat| stat.log_density).collect())?.unbind(),
        acceptance_rate: array(py, shape, by_chain().map(|stat| stat.acceptance).collect())?.unbind(),
        energy: array(py, shape, by_chain().map(|stat| stat.energy).collect())?.unbind(),
        diverging: array(py, shape, by_chain().map(|stat| stat.divergent).collect())?.unbind(),
        step_size,
    })
}
