//! How plausible a latent is, given what was observed of a row.
//!
//! Inverse maps and inference climb this density.
//!
//! Grochow, Martin, Hertzmann & Popović (2004), with the observed outputs o of a row y, their number n, s² = var(x) + w and the deviations r_o = (y_o − μ_o(x)) / scale_o:
//!
//! ```text
//! log p(y_o, x) = −Σ_o r_o² / (2 s²) − (n/2) log s² + log p(x)
//! ```
//!
//! without constants. Nothing observed and n = D is a prior of latents that prefers where poses are known (Urtasun, Fleet, Hertzmann & Fua 2005).

use crate::Error;
use crate::mapping::Mapping;
use crate::model::{LatentModel, RootPrior};
use sinew_core::density::{LaneDensity, LaneGaussNewton};
use sinew_core::elementary::ln;
use sinew_core::lanes::Real;
use std::sync::Arc;

/// A normal prior of a latent with independent coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct LatentPrior {
    /// Mean, length q.
    pub mean: Vec<f64>,
    /// Inverse variances, length q.
    pub precision: Vec<f64>,
}

impl LatentPrior {
    /// N(0, I) where the model says so, else the mean and the variance of a node's own latents.
    #[must_use]
    pub fn of(model: &LatentModel, node: usize) -> Self {
        let own = &model.nodes[node];
        if model.prior == RootPrior::Normal && model.roots().contains(&node) {
            return Self { mean: vec![0.0; own.dim], precision: vec![1.0; own.dim] };
        }
        let count = own.rows.len() as f64;
        let column = |j: usize| own.latents.iter().skip(j).step_by(own.dim);
        let mean: Vec<f64> = (0..own.dim).map(|j| column(j).sum::<f64>() / count).collect();
        let variance = |j: usize| column(j).map(|x| (x - mean[j]).powi(2)).sum::<f64>() / count;
        let precision = (0..own.dim).map(|j| 1.0 / variance(j).max(1e-12)).collect();
        Self { mean, precision }
    }
}

/// The density.
#[derive(Clone, Debug)]
pub struct LatentDensity {
    /// From latents to outputs.
    pub mapping: Arc<Mapping>,
    /// Prior of latents.
    pub prior: LatentPrior,
    /// Places of the outputs that were observed, and their values in the outputs' units.
    pub observed: Vec<(usize, f64)>,
    /// n, the number of outputs that count in the variance: of those observed, or of all for a prior of latents.
    pub count: f64,
}

impl LatentDensity {
    /// Of latents, given some outputs of a row: their places among the outputs and their values, in the outputs' units.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a value that is not finite or at no place of an output, [`Error::Shape`] for a prior of another dimension.
    pub fn given(mapping: Arc<Mapping>, prior: LatentPrior, observed: Vec<(usize, f64)>) -> Result<Self, Error> {
        let outputs = mapping.outputs();
        if let Some(&(index, value)) = observed.iter().find(|(place, value)| *place >= outputs || !value.is_finite()) {
            let expected = "must be finite, at the place of an output";
            return Err(Error::OutOfRange { name: "observed output", index, value, expected });
        }
        for found in [prior.mean.len(), prior.precision.len()] {
            if found != mapping.dim() {
                return Err(Error::Shape { name: "prior of latents", found, expected: mapping.dim() });
            }
        }
        let count = observed.len() as f64;
        Ok(Self { mapping, prior, observed, count })
    }

    /// Of latents by themselves: where poses are known.
    #[must_use]
    pub fn prior_of(mapping: Arc<Mapping>, prior: LatentPrior) -> Self {
        let count = mapping.outputs() as f64;
        Self { mapping, prior, observed: vec![], count }
    }
}

impl LaneDensity for LatentDensity {
    fn dim(&self) -> usize {
        self.mapping.dim()
    }

    fn workspace(&self) -> usize {
        self.mapping.workspace() + 2 * self.mapping.outputs() + self.mapping.dim()
    }

    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let outputs = self.mapping.outputs();
        let (mean, ws) = ws.split_at_mut(outputs);
        let (force, ws) = ws.split_at_mut(outputs);
        let (slope, ws) = ws.split_at_mut(self.mapping.dim());
        let noise = V::splat(self.mapping.noise());
        let variance = self.mapping.variance::<V, GRAD>(x, slope, ws) + noise;
        let precision = V::splat(1.0) / variance;
        let mut misfit = V::splat(0.0);
        if !self.observed.is_empty() {
            self.mapping.mean::<V>(x, mean, ws);
            for f in force.iter_mut() {
                V::splat(0.0).store(f);
            }
            for &(place, value) in &self.observed {
                let inverse = V::splat(1.0 / self.mapping.scale()[place]);
                let deviation = (V::splat(value) - V::load(&mean[place])) * inverse;
                misfit = deviation.fma(deviation, misfit);
                (deviation * inverse * precision).store(&mut force[place]);
            }
        }
        let fit = misfit * precision;
        let mut value = (fit + ln(variance) * V::splat(self.count)) * V::splat(-0.5);
        if GRAD {
            if self.observed.is_empty() {
                for g in grad.iter_mut() {
                    V::splat(0.0).store(g);
                }
            } else {
                self.mapping.pullback::<V>(x, force, grad, ws);
            }
        }
        let along = (fit - V::splat(self.count)) * precision * V::splat(0.5);
        for (j, x) in x.iter().enumerate() {
            let away = V::load(x) - V::splat(self.prior.mean[j]);
            let pull = away * V::splat(-self.prior.precision[j]);
            value = (pull * V::splat(0.5)).fma(away, value);
            if GRAD {
                (V::load(&slope[j]).fma(along, V::load(&grad[j])) + pull).store(&mut grad[j]);
            }
        }
        value
    }
}

/// The prior's precision alone: the rest bends both ways.
impl LaneGaussNewton for LatentDensity {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, _x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (d, &precision) in diagonal.iter_mut().zip(&self.prior.precision) {
            V::splat(precision).store(d);
        }
    }
}
