//! From an output row back to its latent: regression, then a few steps up [`LatentDensity`].
//!
//! Start: kernel ridge regression from outputs to latents, fitted on the rows that were learned from (ridge 10⁻³, width the median distance), or the model's own back constraint; and the latent of the nearest known row. The likelier of both
//! climbs by L-BFGS. With no steps regression alone is the inverse: it is smooth, and does not ask a density that is sharp where outputs have next to no noise, as the latents of children have.

use crate::Error;
use crate::back_constraint::{BackConstraint, squared_distance};
use crate::latent_density::{LatentDensity, LatentPrior};
use crate::mapping::Mapping;
use crate::model::{LatentModel, Outputs};
use sinew_core::density::{GradLogDensity, Lanes};
use sinew_core::lanes::Isa;
use sinew_core::lbfgs::{Lbfgs, Objective};
use std::sync::Arc;

/// Ridge of the regression from outputs to latents.
const RIDGE: f64 = 1e-3;

/// The inverse map of one node.
#[derive(Clone, Debug)]
pub struct Inverse {
    mapping: Arc<Mapping>,
    prior: LatentPrior,
    regression: BackConstraint,
    /// Outputs that were learned from, standardised, rows one after the other.
    known: Vec<f64>,
    /// From outputs in their units to standardised ones.
    centre: Vec<f64>,
    scale: Vec<f64>,
    steps: usize,
}

impl Inverse {
    /// Of a node, with at most this many steps up the density; with none it is regression alone.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn new(model: &LatentModel, node: usize, mapping: Arc<Mapping>, steps: usize) -> Result<Self, Error> {
        let own = &model.nodes[node];
        let (known, cols) = (model.prepared(node), model.output_count(node));
        let regression = match &own.back {
            Some(back) => back.clone(),
            None => BackConstraint::fit(&known, cols, &own.latents, own.dim, RIDGE)?,
        };
        let (centre, scale) = match &own.outputs {
            Outputs::Columns(columns) => {
                columns.iter().map(|&j| (model.standard.mean[j], model.standard.scale[j])).unzip()
            }
            Outputs::Nodes(_) => (vec![0.0; cols], vec![1.0; cols]),
        };
        Ok(Self { prior: LatentPrior::of(model, node), mapping, regression, known, centre, scale, steps })
    }

    /// The latent, length q, of a row of all outputs, in their units.
    #[must_use]
    pub fn latent(&self, row: &[f64]) -> Vec<f64> {
        let (dim, cols) = (self.mapping.dim(), row.len());
        let units = row.iter().zip(&self.centre).zip(&self.scale);
        let prepared: Vec<f64> = units.map(|((y, centre), scale)| (y - centre) / scale).collect();
        let regressed = self.regression.latent(&prepared, &self.known, dim);
        if self.steps == 0 {
            return regressed;
        }
        let distances = self.known.chunks_exact(cols).map(|known| squared_distance(known, &prepared));
        let nearest = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(n, _)| n);
        let nearest = &self.mapping.latents()[nearest * dim..][..dim];
        let observed: Vec<(usize, f64)> = row.iter().copied().enumerate().collect();
        let (mapping, prior, count) = (self.mapping.clone(), self.prior.clone(), cols as f64);
        let leaf = LatentDensity { mapping, prior, observed, count };
        let mut density = Ascent(Lanes { leaf, isa: Isa::baseline() });
        let starts = [regressed, nearest.to_vec()].map(|x| Lbfgs::new(&mut density, x));
        let [regressed, nearest] = starts;
        let mut search = if nearest.value < regressed.value { nearest } else { regressed };
        for _ in 0..self.steps {
            if !search.step(&mut density) {
                break;
            }
        }
        search.x
    }
}

/// The negative of a log density, to be minimised.
pub(crate) struct Ascent(pub(crate) Lanes<LatentDensity>);

impl Objective for Ascent {
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let value = self.0.log_density_grad(x, gradient);
        gradient.iter_mut().for_each(|g| *g = -*g);
        if value.is_finite() { -value } else { f64::INFINITY }
    }
}
