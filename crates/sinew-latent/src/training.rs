//! Learning of a model, step by step: it can be watched, stopped, stored and resumed to the same bits.
//!
//! L-BFGS on all unknowns together. Where weights W are learned (GPDM), they are set to their optimum before every round of steps, and the search begins afresh, as Wang, Fleet & Hertzmann do with scaled conjugate gradients.

use crate::Error;
use crate::model::LatentModel;
use crate::objective::Cost;
use serde::{Deserialize, Serialize};
use sinew_core::lanes::Isa;
use sinew_core::lbfgs::Lbfgs;

/// When learning ends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Steps at most.
    pub steps: usize,
    /// Steps between two updates of the weights W, where these are learned.
    pub round: usize,
    /// Ends where no entry of the gradient is above this times the number of rows.
    pub steepness: f64,
    /// With weights: ends where the objective changed by less than this, relatively, over five rounds.
    pub change: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { steps: 1000, round: 10, steepness: 1e-4, change: 1e-5 }
    }
}

/// Where learning stands; plain data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learning {
    /// The model at the best unknowns so far.
    pub model: LatentModel,
    /// When it ends.
    pub config: Config,
    search: Lbfgs,
    /// Steps of the rounds before this one.
    before: usize,
    /// Objective at the end of each round.
    rounds: Vec<f64>,
    finished: bool,
}

/// What a watcher wants to know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Steps made.
    pub steps: usize,
    /// −log p of data and latents (with the priors of parameters).
    pub objective: f64,
    /// Largest entry of its gradient.
    pub steepness: f64,
    /// Whether learning has ended.
    pub finished: bool,
}

/// Learning under way, with its scratch.
pub struct Training {
    cost: Cost,
    state: Learning,
}

impl Training {
    /// Starts from a model.
    ///
    /// # Errors
    /// A model that does not fit together, or whose covariance cannot be factored.
    pub fn new(model: LatentModel, config: Config, isa: Isa) -> Result<Self, Error> {
        let mut cost = Cost::new(model, isa)?;
        let unknowns = cost.unknowns();
        let mut search = Lbfgs::new(&mut cost, unknowns);
        if cost.model.kappa.is_some() && search.value.is_finite() {
            cost.update_weights();
            search = Lbfgs::new(&mut cost, search.x);
        }
        if !search.value.is_finite() {
            return Err(cost.failure.take().unwrap_or(Error::NotFinite));
        }
        let state = Learning { model: cost.model.clone(), config, search, before: 0, rounds: vec![], finished: false };
        Ok(Self { cost, state })
    }

    /// Continues from a stored state.
    ///
    /// # Errors
    /// A state whose parts do not fit together.
    pub fn resume(state: Learning, isa: Isa) -> Result<Self, Error> {
        let cost = Cost::new(state.model.clone(), isa)?;
        let (found, expected) = (state.search.x.len(), cost.unknowns().len());
        if found != expected || state.search.gradient.len() != expected {
            return Err(Error::Shape { name: "unknowns of a stored search", found, expected });
        }
        Ok(Self { cost, state })
    }

    /// Makes one step.
    pub fn step(&mut self) -> Progress {
        let Learning { config, search, before, .. } = &mut self.state;
        let moved = search.step(&mut self.cost);
        let (steps, flat) =
            (*before + search.iterations, search.steepness() <= config.steepness * self.cost.model.rows() as f64);
        let exhausted = steps >= config.steps;
        if self.cost.model.kappa.is_none() {
            self.state.finished = !moved || flat || exhausted;
        } else if !moved || flat || exhausted || search.iterations >= config.round {
            self.end_round(steps);
            self.state.finished |= exhausted;
        }
        self.progress()
    }

    /// Sets the weights and begins a new round.
    fn end_round(&mut self, steps: usize) {
        let state = &mut self.state;
        let mut unused = vec![0.0; state.search.x.len()];
        sinew_core::lbfgs::Objective::evaluate(&mut self.cost, &state.search.x, &mut unused);
        self.cost.update_weights();
        state.search = Lbfgs::new(&mut self.cost, std::mem::take(&mut state.search.x));
        state.before = steps;
        state.rounds.push(state.search.value);
        state.model = self.cost.model.clone();
        if let [.., old, _, _, _, _, new] = state.rounds[..] {
            state.finished = (old - new).abs() < state.config.change * new.abs();
        }
    }

    /// Steps until the end; `watch` may stop it by answering false.
    pub fn run(&mut self, mut watch: impl FnMut(Progress) -> bool) -> Progress {
        let mut progress = self.progress();
        while !progress.finished && watch(progress) {
            progress = self.step();
        }
        progress
    }

    /// Where it stands.
    #[must_use]
    pub fn progress(&self) -> Progress {
        let Learning { search, before, finished, .. } = &self.state;
        Progress {
            steps: before + search.iterations,
            objective: search.value,
            steepness: search.steepness(),
            finished: *finished,
        }
    }

    /// The state to be stored.
    pub fn state(&mut self) -> &Learning {
        self.cost.set(&self.state.search.x);
        self.state.model.clone_from(&self.cost.model);
        &self.state
    }

    /// The model at the best unknowns so far.
    #[must_use]
    pub fn into_model(mut self) -> LatentModel {
        self.cost.set(&self.state.search.x);
        self.cost.model
    }
}

/// −log p of a model as it stands, and its gradient in the unknowns: latents (or coefficients) and logarithms of learned parameters, node by node, then the parameters of the dynamics.
///
/// # Errors
/// A model that does not fit together, or whose covariance cannot be factored.
pub fn objective(model: &LatentModel, isa: Isa) -> Result<(f64, Vec<f64>), Error> {
    let mut cost = Cost::new(model.clone(), isa)?;
    let unknowns = cost.unknowns();
    let mut gradient = vec![0.0; unknowns.len()];
    let value = sinew_core::lbfgs::Objective::evaluate(&mut cost, &unknowns, &mut gradient);
    if value.is_finite() { Ok((value, gradient)) } else { Err(cost.failure.take().unwrap_or(Error::NotFinite)) }
}

/// The objective as a function of the unknowns, for optimisers and benchmarks.
pub struct Landscape(Cost);

impl Landscape {
    /// Of a model, whose unknowns are returned.
    ///
    /// # Errors
    /// A model that does not fit together.
    pub fn new(model: LatentModel, isa: Isa) -> Result<(Self, Vec<f64>), Error> {
        let cost = Cost::new(model, isa)?;
        let unknowns = cost.unknowns();
        Ok((Self(cost), unknowns))
    }
}

impl sinew_core::lbfgs::Objective for Landscape {
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.0.evaluate(x, gradient)
    }
}
