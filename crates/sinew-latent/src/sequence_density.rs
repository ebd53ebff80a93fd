//! How plausible the latents of a whole sequence are, given what was observed of its rows.
//!
//! With s_t² = var(x_t) + w, the observed outputs o of row t, their number n_t and the deviations r_to = (y_to − μ_o(x_t)) / scale_o:
//!
//! ```text
//! log p = Σ_t [−Σ_o r_to² / (2 s_t²) − (n_t/2) log s_t²] + λ Σ_t ℓ_t
//! ℓ_t = log p(x_t)                                        rows by themselves
//! ℓ_t = −½ Σ_j p_j (x_tj − x_{t−1,j})²                    a random walk
//! ℓ_t = −‖x_t − φ(x_{t−1})‖² / (2 v_t) − (q/2) log v_t    the dynamics of the model, v_t = s_X²(x_{t−1}) + 1/a₄
//! ```
//!
//! without constants; the first latent has its normal prior. λ is the balance of the model's own prior (Urtasun, Fleet & Fua 2006). Both sums are of one kind, a Gaussian process at x_t that is compared with a target: the row, or the next latent. Eight
//! rows are evaluated together.

use crate::Error;
use crate::latent_density::LatentPrior;
use crate::mapping::Mapping;
use crate::motion::LatentMotion;
use rayon::prelude::*;
use sinew_core::elementary::ln;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::lbfgs::Objective;
use std::sync::Arc;

/// What links the latents of consecutive rows.
#[derive(Clone, Debug)]
pub enum SequenceLink {
    /// Nothing: each has the prior.
    None,
    /// Steps are normal with these precisions.
    Walk(Vec<f64>),
    /// The dynamics of the model, with the variance that they predict.
    Dynamics(LatentMotion),
}

/// The density of a sequence of latents, rows of q.
#[derive(Clone, Debug)]
pub struct SequenceDensity {
    /// From latents to outputs.
    pub mapping: Arc<Mapping>,
    /// Prior of the first latent, or of each where nothing links them.
    pub prior: LatentPrior,
    /// What links them.
    pub link: SequenceLink,
    /// λ.
    pub balance: f64,
    rows: usize,
    /// Targets and reciprocals of their scales (0 where missing), a block a row of eight and output.
    targets: Vec<Block>,
    inverse: Vec<Block>,
    isa: Isa,
}

impl SequenceDensity {
    /// Of the latents of rows, each with the places of the outputs that were observed and their values in the outputs' units.
    ///
    /// # Errors
    /// [`Error::Shape`] and [`Error::OutOfRange`] where there are no rows, or places or precisions that do not fit.
    pub fn new(
        mapping: Arc<Mapping>,
        prior: LatentPrior,
        link: SequenceLink,
        balance: f64,
        observed: &[Vec<(usize, f64)>],
        isa: Isa,
    ) -> Result<Self, Error> {
        let (dim, outputs, rows) = (mapping.dim(), mapping.outputs(), observed.len());
        let shape = |name, found, expected| {
            if found == expected { Ok(()) } else { Err(Error::Shape { name, found, expected }) }
        };
        shape("rows of a sequence", rows, rows.max(1))?;
        shape("prior of latents", prior.mean.len(), dim)?;
        match &link {
            SequenceLink::None => {}
            SequenceLink::Walk(precision) => {
                shape("precisions of latent steps", precision.len(), dim)?;
                crate::ranges::positive("precision of a latent step", precision)?;
            }
            SequenceLink::Dynamics(motion) => shape("coordinates of the dynamics", motion.mapping().dim(), dim)?,
        }
        crate::ranges::positive("balance", &[balance])?;
        let count = rows.div_ceil(LANES) * outputs;
        let (mut targets, mut inverse) = (vec![Block::ZERO; count], vec![Block::ZERO; count]);
        for (t, row) in observed.iter().enumerate() {
            for &(place, value) in row {
                if place >= outputs || !value.is_finite() {
                    let expected = "must be finite, at the place of an output";
                    return Err(Error::OutOfRange { name: "observed output", index: place, value, expected });
                }
                let block = t / LANES * outputs + place;
                targets[block].0[t % LANES] = value;
                inverse[block].0[t % LANES] = 1.0 / mapping.scale()[place];
            }
        }
        Ok(Self { mapping, prior, link, balance, rows, targets, inverse, isa })
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Coordinates q of a latent.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.mapping.dim()
    }

    /// Log density; its gradient is written to `gradient`, as long as `x`.
    #[must_use]
    pub fn log_density_grad(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        gradient.fill(0.0);
        let dim = self.dim();
        let mut value = fit(&self.mapping, x, &self.targets, &self.inverse, self.rows, 1.0, self.isa, gradient).0;
        let normal = |t: usize, gradient: &mut [f64]| {
            let mut sum = 0.0;
            for j in 0..dim {
                let (away, precision) = (x[t * dim + j] - self.prior.mean[j], self.prior.precision[j]);
                gradient[t * dim + j] -= self.balance * precision * away;
                sum -= 0.5 * precision * away * away;
            }
            sum
        };
        let mut linked = normal(0, gradient);
        match &self.link {
            SequenceLink::None => linked += (1..self.rows).map(|t| normal(t, gradient)).sum::<f64>(),
            SequenceLink::Walk(precision) => {
                for i in dim..self.rows * dim {
                    let (step, precision) = (x[i] - x[i - dim], precision[i % dim]);
                    linked -= 0.5 * precision * step * step;
                    gradient[i] -= self.balance * precision * step;
                    gradient[i - dim] += self.balance * precision * step;
                }
            }
            SequenceLink::Dynamics(motion) => linked += self.dynamics(motion, x, gradient),
        }
        value += self.balance * linked;
        value
    }

    /// The fit of each row at each latent that was learned from, without what is the same at all of them but the variance.
    pub(crate) fn known_fits(&self) -> Vec<Vec<f64>> {
        let (dim, outputs) = (self.dim(), self.mapping.outputs());
        let at = |x: &[f64]| {
            let (mean, variance) = (self.mapping.mean_at(x), self.mapping.variance_at(x) + self.mapping.noise());
            let fit = |t: usize| {
                let (mut misfit, mut count) = (0.0, 0.0);
                for (d, mean) in mean.iter().enumerate() {
                    let (block, lane) = (t / LANES * outputs + d, t % LANES);
                    let inverse = self.inverse[block].0[lane];
                    misfit += ((self.targets[block].0[lane] - mean) * inverse).powi(2);
                    count += f64::from(u8::from(inverse > 0.0));
                }
                -0.5 * (misfit / variance + count * variance.ln())
            };
            (0..self.rows).map(fit).collect()
        };
        let known: Vec<Vec<f64>> = self.mapping.latents().par_chunks_exact(dim).map(at).collect();
        (0..self.rows).map(|t| known.iter().map(|fits| fits[t]).collect()).collect()
    }

    /// Mean, precisions and log of the volume of the step from a latent, as λ weighs them.
    pub(crate) fn step_from(&self, x: &[f64]) -> (Vec<f64>, Vec<f64>, f64) {
        match &self.link {
            SequenceLink::None => (vec![], vec![], 0.0),
            SequenceLink::Walk(precision) => (x.to_vec(), precision.iter().map(|p| self.balance * p).collect(), 0.0),
            SequenceLink::Dynamics(motion) => {
                let variance = motion.mapping().variance_at(x) + motion.mapping().noise();
                let constant = -0.5 * self.balance * x.len() as f64 * variance.ln();
                (motion.mean(x), vec![self.balance / variance; x.len()], constant)
            }
        }
    }

    /// Σ_t ℓ_t from the second row on.
    fn dynamics(&self, motion: &LatentMotion, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (dim, steps) = (self.dim(), self.rows - 1);
        let count = steps.div_ceil(LANES) * dim;
        let (mut targets, mut inverse) = (vec![Block::ZERO; count], vec![Block::ZERO; count]);
        for t in 0..steps {
            for j in 0..dim {
                let block = t / LANES * dim + j;
                targets[block].0[t % LANES] = x[(t + 1) * dim + j];
                inverse[block].0[t % LANES] = 1.0;
            }
        }
        let (before, balance) = (&x[..steps * dim], self.balance);
        let (value, pulls) = fit(motion.mapping(), before, &targets, &inverse, steps, balance, self.isa, gradient);
        for t in 0..steps {
            for j in 0..dim {
                gradient[(t + 1) * dim + j] -= balance * pulls[t / LANES * dim + j].0[t % LANES];
            }
        }
        value
    }
}

/// The negative of the log density, to be minimised.
impl Objective for SequenceDensity {
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let value = self.log_density_grad(x, gradient);
        gradient.iter_mut().for_each(|g| *g = -*g);
        if value.is_finite() { -value } else { f64::INFINITY }
    }
}

/// Σ_t log N(target_t; μ(x_t), s_t²) without constants; `factor` times its gradient in the latents is added to `gradient`. With the derivatives in the means.
#[allow(clippy::too_many_arguments)]
fn fit(
    mapping: &Mapping,
    x: &[f64],
    targets: &[Block],
    inverse: &[Block],
    rows: usize,
    factor: f64,
    isa: Isa,
    gradient: &mut [f64],
) -> (f64, Vec<Block>) {
    let (dim, outputs) = (mapping.dim(), mapping.outputs());
    let one = |b: usize| {
        // Lanes behind the last row stand where it stands, with nothing observed.
        let row = |lane: usize| (b * LANES + lane).min(rows - 1);
        let x: Vec<Block> = (0..dim).map(|j| Block(std::array::from_fn(|lane| x[row(lane) * dim + j]))).collect();
        let (mut slopes, mut pulls) = (vec![Block::ZERO; dim], vec![Block::ZERO; outputs]);
        let (mut value, mut ws) = ([Block::ZERO], vec![Block::ZERO; mapping.workspace() + outputs + dim]);
        let range = b * outputs..(b + 1) * outputs;
        let (target, inverse) = (&targets[range.clone()], &inverse[range]);
        let (slopes_out, pulls_out) = (&mut slopes[..], &mut pulls[..]);
        let (value_out, ws) = (&mut value, &mut ws[..]);
        dispatch(
            isa,
            Fit { mapping, x: &x, target, inverse, slopes: slopes_out, pulls: pulls_out, value: value_out, ws },
        );
        (value[0], slopes, pulls)
    };
    let blocks: Vec<(Block, Vec<Block>, Vec<Block>)> = (0..rows.div_ceil(LANES)).into_par_iter().map(one).collect();
    let (mut value, mut all) = (0.0, Vec::with_capacity(blocks.len() * outputs));
    for (b, (values, slopes, pulls)) in blocks.into_iter().enumerate() {
        for t in b * LANES..rows.min((b + 1) * LANES) {
            value += values.0[t % LANES];
            (0..dim).for_each(|j| gradient[t * dim + j] += factor * slopes[j].0[t % LANES]);
        }
        all.extend(pulls);
    }
    (value, all)
}

/// Eight rows compared with their targets.
struct Fit<'a> {
    mapping: &'a Mapping,
    x: &'a [Block],
    target: &'a [Block],
    inverse: &'a [Block],
    /// Derivatives in the latents.
    slopes: &'a mut [Block],
    /// Derivatives in the means.
    pulls: &'a mut [Block],
    value: &'a mut [Block; 1],
    ws: &'a mut [Block],
}

impl Kernel<Block> for Fit<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let Self { mapping, x, target, inverse, slopes, pulls, value, ws } = self;
        let (mean, ws) = ws.split_at_mut(mapping.outputs());
        let (slope, ws) = ws.split_at_mut(mapping.dim());
        let variance = mapping.variance::<V, true>(x, slope, ws) + V::splat(mapping.noise());
        let precision = V::splat(1.0) / variance;
        mapping.mean::<V>(x, mean, ws);
        let (mut misfit, mut count) = (V::splat(0.0), V::splat(0.0));
        for (((target, mean), inverse), pull) in target.iter().zip(&*mean).zip(inverse.iter()).zip(pulls.iter_mut()) {
            let inverse = V::load(inverse);
            let deviation = (V::load(target) - V::load(mean)) * inverse;
            misfit = deviation.fma(deviation, misfit);
            count = inverse.select_gt(0.0, count + V::splat(1.0), count);
            (deviation * inverse * precision).store(pull);
        }
        mapping.pullback::<V>(x, pulls, slopes, ws);
        let fit = misfit * precision;
        ((fit + ln(variance) * count) * V::splat(-0.5)).store(&mut value[0]);
        let along = (fit - count) * precision * V::splat(0.5);
        for (g, slope) in slopes.iter_mut().zip(&*slope) {
            V::load(slope).fma(along, V::load(g)).store(g);
        }
    }
}
