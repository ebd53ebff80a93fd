//! No-U-turn and Hamiltonian chains on a log density written in Python.

use crate::arrays::{affordable, array, numbers, record};
use crate::background::interruptible;
use crate::failure::{Failure, USAGE};
use crate::log_density::PythonDensity;
use pyo3::exceptions::PyRuntimeWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::samplers::chains::ChainStat;
use sinew::samplers::warm_up::SHORTEST;
use sinew::samplers::{Error, Run, Starts, hmc, nuts};
use std::ffi::CString;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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
///
/// Returns
/// -------
/// A `ChainDraws`. What speaks against the draws is a `RuntimeWarning` each: divergences, trees at `max_depth`, E-BFMI below 0.3, R-hat above 1.01, fewer than 100 effective draws a chain.
#[pyfunction]
#[pyo3(name = "nuts", signature = (log_density, starts, *, draws = 1000, warm_up = 850, acceptance = 0.8, max_depth = 10, seed = 0))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn no_u_turn<'py>(
    py: Python<'py>,
    log_density: Py<PyAny>,
    starts: &Bound<'_, PyAny>,
    draws: usize,
    warm_up: usize,
    acceptance: f64,
    max_depth: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let plan = Plan { draws, warm_up, acceptance, seed, trajectories: Trajectories::NoUTurn { max_depth } };
    sample(py, &log_density, starts, plan)
}

/// Hamiltonian Monte Carlo with trajectories of fixed length on a log density written in Python.
///
/// The slow path, as `nuts` is. The metric comes from the same warm-up, the step size from trials with trajectories of this length.
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
pub(crate) fn hamiltonian<'py>(
    py: Python<'py>,
    log_density: Py<PyAny>,
    starts: &Bound<'_, PyAny>,
    draws: usize,
    warm_up: usize,
    acceptance: f64,
    leapfrog_steps: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
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
        if self.draws == 0 || self.warm_up < SHORTEST {
            return Err(refused(format!(
                "`draws` is {} and `warm_up` is {}; at least 1 and {SHORTEST} are needed",
                self.draws, self.warm_up
            )));
        }
        if !(self.acceptance > 0.0 && self.acceptance < 1.0) {
            return Err(refused(format!("`acceptance` is {}; it must be between 0 and 1", self.acceptance)));
        }
        Ok(())
    }

    fn run(&self, target: &PythonDensity<'_>, starts: Vec<Vec<f64>>) -> Result<Run, Error> {
        let Self { draws, warm_up, acceptance, seed, .. } = *self;
        let (chains, starts) = (starts.len(), Starts::Given(starts));
        match self.trajectories {
            Trajectories::NoUTurn { max_depth } => {
                let settings = nuts::Settings {
                    chains,
                    draws,
                    warm_up,
                    seed,
                    starts,
                    acceptance,
                    max_depth,
                    ..Default::default()
                };
                nuts::sample(target, settings)
            }
            Trajectories::Fixed { leapfrog_steps } => {
                let lengths = vec![leapfrog_steps];
                let settings = hmc::Settings {
                    chains,
                    draws,
                    warm_up,
                    seed,
                    starts,
                    acceptance,
                    lengths,
                    jitter: 0.2,
                    ..Default::default()
                };
                hmc::sample(target, settings)
            }
        }
    }
}

fn sample<'py>(
    py: Python<'py>,
    function: &Py<PyAny>,
    starts: &Bound<'_, PyAny>,
    plan: Plan,
) -> PyResult<Bound<'py, PyAny>> {
    plan.check()?;
    let starts = numbers("starts", starts)?;
    let shape = starts.exactly(&[("chains", None), ("dim", None)])?;
    let (chains, dim) = (shape[0], shape[1]);
    if chains == 0 || dim == 0 {
        return Err(Failure::argument("`starts` is empty; give one row a chain").into());
    }
    // The draws twice, and what is known of each.
    affordable(&[plan.draws.max(plan.warm_up), chains, 2 * dim + 10])?;
    let starts: Vec<Vec<f64>> = starts.finite()?.chunks(dim).map(<[f64]>::to_vec).collect();
    let mut raised = None;
    let stop = Arc::new(AtomicBool::new(false));
    let outcome = interruptible(
        py,
        &stop,
        |_| Ok(()),
        || {
            let target = PythonDensity::new(function, dim, &stop);
            let found = plan.run(&target, starts);
            raised = target.raised();
            if stop.load(Ordering::Relaxed) { Ok(None) } else { Ok(Some(found)) }
        },
    )?;
    if let Some(raised) = raised {
        return Err(raised);
    }
    match outcome {
        Some(found) => gathered(py, found.map_err(Failure::from)?),
        None => Err(Failure::bug("stopped without a signal").into()),
    }
}

fn gathered(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyAny>> {
    let (shape, summary) = ([run.chains, run.draws()], run.summary());
    let warnings: Vec<String> = summary.warnings.iter().map(ToString::to_string).collect();
    for warning in &warnings {
        let text = CString::new(warning.as_str()).map_err(|error| Failure::bug(error.to_string()))?;
        PyErr::warn(py, &py.get_type::<PyRuntimeWarning>(), &text, 1)?;
    }
    let numbers = |of: fn(&ChainStat) -> f64| array(py, shape, run.stats.iter().map(of).collect());
    let counts = |of: fn(&ChainStat) -> u32| array(py, shape, run.stats.iter().map(of).collect());
    let made = PyDict::new(py);
    made.set_item("lp", numbers(|stat| stat.log_density)?)?;
    made.set_item("acceptance_rate", numbers(|stat| stat.acceptance)?)?;
    made.set_item("energy", numbers(|stat| stat.energy)?)?;
    made.set_item("diverging", array(py, shape, run.stats.iter().map(|stat| stat.divergent).collect())?)?;
    made.set_item("leapfrog_steps", counts(|stat| stat.leapfrog_steps)?)?;
    made.set_item("depth", counts(|stat| stat.depth)?)?;
    made.set_item("step_size", run.step_size)?;
    made.set_item("summary", summary.to_string())?;
    made.set_item("warnings", warnings)?;
    made.set_item("draws", array(py, [run.chains, run.draws(), run.dim()], run.states)?)?;
    record(py, "ChainDraws", &made)
}
