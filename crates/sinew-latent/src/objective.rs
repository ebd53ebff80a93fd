//! What learning minimises: −log p of data and latents, with its gradient.
//!
//! The vector of unknowns holds, node by node, the latents (or the coefficients of a back constraint) and the logarithms of the learned parameters of the covariance, then the parameters of the dynamics. White noise below [`LEAST_NOISE`]
//! counts as that: a precision that runs away is held (a stretch without slope).

use crate::Error;
use crate::back_constraint::BackMap;
use crate::columns::Columns;
use crate::covariance::{Covariance, Learned, PARAMETERS, count};
use crate::dynamics::{Dynamics, Successors};
use crate::model::{LatentModel, Outputs, RootPrior};
use crate::process::Process;
use sinew_core::lanes::Isa;
use sinew_core::lbfgs::Objective;

/// The least variance of white noise that is learned.
pub const LEAST_NOISE: f64 = 1e-6;
/// Place of the white noise among the parameters.
const WHITE: usize = PARAMETERS - 1;

/// The model at the unknowns of the last evaluation, and scratch.
pub(crate) struct Cost {
    pub(crate) model: LatentModel,
    processes: Vec<Process>,
    outputs: Vec<Columns>,
    back: Vec<Option<BackMap>>,
    /// One a root, in the order of the roots.
    dynamics: Vec<Dynamics>,
    roots: Vec<usize>,
    /// Gradients of latents, node by node.
    pulls: Vec<Vec<f64>>,
    /// Why the last evaluation had no value.
    pub(crate) failure: Option<Error>,
}

impl Cost {
    pub(crate) fn new(model: LatentModel, isa: Isa) -> Result<Self, Error> {
        model.check()?;
        let roots = model.roots();
        let mut dynamics = Vec::new();
        if let RootPrior::Dynamics { .. } = model.prior {
            for &root in &roots {
                let node = &model.nodes[root];
                let successors = Successors::new(&model.sequences_within(&node.rows), node.rows.len())?;
                dynamics.push(Dynamics::new(successors, node.dim, isa));
            }
        }
        let nodes = model.nodes.iter().enumerate();
        let processes = nodes
            .clone()
            .map(|(n, node)| Process::new(node.rows.len(), node.dim, model.output_count(n), isa))
            .collect();
        let outputs =
            (0..model.nodes.len()).map(|n| Columns::from_rows(&model.weighed(n), model.output_count(n))).collect();
        let back = nodes.map(|(n, node)| {
            node.back.as_ref().map(|back| BackMap::new(back, &model.prepared(n), model.output_count(n), node.dim))
        });
        let back = back.collect();
        let pulls = model.nodes.iter().map(|node| vec![0.0; node.latents.len()]).collect();
        Ok(Self { processes, outputs, back, dynamics, roots, pulls, failure: None, model })
    }

    /// The unknowns of the model as it stands.
    pub(crate) fn unknowns(&self) -> Vec<f64> {
        let mut unknowns = Vec::new();
        let mut logs = [0.0; PARAMETERS];
        for node in &self.model.nodes {
            unknowns.extend_from_slice(node.back.as_ref().map_or(&node.latents, |back| &back.coefficients));
            let learned = node.covariance.write_logs(&node.learned, &mut logs);
            unknowns.extend_from_slice(&logs[..learned]);
        }
        if let RootPrior::Dynamics { covariance, learned, .. } = &self.model.prior {
            let learned = covariance.write_logs(learned, &mut logs);
            unknowns.extend_from_slice(&logs[..learned]);
        }
        unknowns
    }

    /// Sets the model to these unknowns.
    pub(crate) fn set(&mut self, mut unknowns: &[f64]) {
        for (node, back) in self.model.nodes.iter_mut().zip(&self.back) {
            let (points, rest) = unknowns.split_at(node.latents.len());
            if let (Some(map), Some(back)) = (back, &mut node.back) {
                back.coefficients.copy_from_slice(points);
                node.latents = map.apply(points);
            } else {
                node.latents.copy_from_slice(points);
            }
            unknowns = take_parameters(&mut node.covariance, &node.learned, rest);
        }
        if let RootPrior::Dynamics { covariance, learned, .. } = &mut self.model.prior {
            take_parameters(covariance, learned, unknowns);
        }
    }

    fn value(&mut self, gradient: &mut [f64]) -> Result<f64, Error> {
        self.pulls.iter_mut().for_each(|pull| pull.fill(0.0));
        let mut value = 0.0;
        for n in 0..self.model.nodes.len() {
            value += self.node(n)?;
        }
        let (prior, slopes) = self.prior()?;
        value += prior;
        let mut place = 0;
        for (n, node) in self.model.nodes.iter().enumerate() {
            let pulls = &mut self.pulls[n];
            self.processes[n].points().add_to_rows(-1.0, pulls);
            let length = pulls.len();
            match &self.back[n] {
                Some(map) => gradient[place..][..length].copy_from_slice(&map.apply(pulls)),
                None => gradient[place..][..length].copy_from_slice(pulls),
            }
            place += length;
            let slopes = self.processes[n].parameters().map(|slope| -slope);
            let written = parameter_slopes(
                &node.covariance,
                &node.learned,
                &slopes,
                self.model.kappa.is_some(),
                &mut gradient[place..],
            );
            (value, place) = (value + written, place + count(&node.learned));
        }
        if let RootPrior::Dynamics { covariance, learned, .. } = &self.model.prior {
            value += parameter_slopes(covariance, learned, &slopes, self.model.kappa.is_some(), &mut gradient[place..]);
        }
        Ok(value)
    }

    /// −log GP of a node's outputs with the prior of its weights; what it says of its children's latents is added to theirs.
    fn node(&mut self, n: usize) -> Result<f64, Error> {
        let node = &self.model.nodes[n];
        if let Outputs::Nodes(_) = node.outputs {
            self.outputs[n].copy_from_rows(&self.model.weighed(n));
        }
        let mut value = -self.processes[n].evaluate(&node.covariance, &node.latents, &self.outputs[n])?;
        if let Outputs::Nodes(children) = &node.outputs {
            let (weights, mut column) = (self.processes[n].weights(), 0);
            for &c in children {
                let (dim, before) = (self.model.nodes[c].dim, node.rows.start - self.model.nodes[c].rows.start);
                for i in 0..node.rows.len() {
                    (0..dim).for_each(|j| self.pulls[c][(before + i) * dim + j] += weights.at(i, column + j));
                }
                column += dim;
            }
        }
        if let Some(kappa) = self.model.kappa {
            let rows = node.rows.len() as f64;
            value += node.weights.iter().map(|w| 0.5 * (w / kappa).powi(2) - rows * w.ln()).sum::<f64>();
        }
        Ok(value)
    }

    /// −log p of the roots' latents, and its slopes in the logarithms of the dynamics' parameters.
    fn prior(&mut self) -> Result<(f64, [f64; PARAMETERS]), Error> {
        let (mut value, mut slopes) = (0.0, [0.0; PARAMETERS]);
        for (k, &root) in self.roots.iter().enumerate() {
            let (latents, pull) = (&self.model.nodes[root].latents, &mut self.pulls[root]);
            match &self.model.prior {
                RootPrior::Flat => {}
                RootPrior::Normal => {
                    value += 0.5 * latents.iter().map(|x| x * x).sum::<f64>();
                    pull.iter_mut().zip(latents).for_each(|(pull, x)| *pull += x);
                }
                RootPrior::Dynamics { covariance, balance, .. } => {
                    let (own, own_slopes) = self.dynamics[k].evaluate(covariance, latents, *balance, pull)?;
                    value += balance * own;
                    slopes.iter_mut().zip(own_slopes).for_each(|(sum, slope)| *sum += slope);
                }
            }
        }
        Ok((value, slopes))
    }

    /// Sets W to its optimum given the rest (Wang, Fleet & Hertzmann 2008): w_k² = N / (y_kᵀ K⁻¹ y_k + κ⁻²). The unknowns must be as in the last evaluation.
    pub(crate) fn update_weights(&mut self) {
        let Some(kappa) = self.model.kappa else { return };
        for n in 0..self.model.nodes.len() {
            let (process, outputs) = (&self.processes[n], &self.outputs[n]);
            let node = &mut self.model.nodes[n];
            let rows = node.rows.len() as f64;
            for (k, w) in node.weights.iter_mut().enumerate() {
                let fit = process.fit(outputs, k) / (*w * *w);
                *w = (rows / (fit + kappa.powi(-2))).sqrt();
            }
            self.outputs[n].copy_from_rows(&self.model.weighed(n));
        }
    }
}

impl Objective for Cost {
    /// Within the pool of threads as a whole, so that its parts are not handed over one by one.
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.set(x);
        match rayon::scope(|_| self.value(gradient)) {
            Ok(value) if value.is_finite() => value,
            Ok(_) => f64::INFINITY,
            Err(error) => {
                self.failure = Some(error);
                f64::INFINITY
            }
        }
    }
}

/// Sets the learned parameters from the front of the unknowns; the rest of the unknowns.
fn take_parameters<'a>(covariance: &mut Covariance, learned: &Learned, unknowns: &'a [f64]) -> &'a [f64] {
    *covariance = covariance.with_logs(learned, unknowns);
    if learned[WHITE] {
        covariance.white = covariance.white.max(LEAST_NOISE);
    }
    &unknowns[count(learned)..]
}

/// Writes the slopes in the learned parameters to the front of `gradient`, with the slopes of their priors where they have any; −log of these priors.
fn parameter_slopes(
    covariance: &Covariance,
    learned: &Learned,
    slopes: &[f64; PARAMETERS],
    has_priors: bool,
    gradient: &mut [f64],
) -> f64 {
    let (mut value, mut place) = (0.0, 0);
    for (i, parameter) in covariance.to_array().into_iter().enumerate() {
        if !learned[i] {
            continue;
        }
        let sign = if i == WHITE { -1.0 } else { 1.0 };
        let held = i == WHITE && parameter <= LEAST_NOISE;
        gradient[place] = if held { 0.0 } else { slopes[i] + if has_priors { sign } else { 0.0 } };
        value += if has_priors { sign * parameter.ln() } else { 0.0 };
        place += 1;
    }
    value
}
