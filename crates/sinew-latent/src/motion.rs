//! How latents move: the mean of the Gaussian process of the dynamics, with normal noise.
//!
//! ```text
//! φ(x) = X_outᵀ K_X⁻¹ k_X(x),   s_X²(x) = k_X(x, x) − k_Xᵀ K_X⁻¹ k_X + 1/a₄
//! x_t = φ(x_{t−1}) + e,   e ~ N(0, s_X² I) as the model says, or N(0, diag(sd²)) as the trackers of Raskin, Rudzsky & Rivlin have it
//! ```

use crate::Error;
use crate::mapping::Mapping;
use crate::model::{LatentModel, RootPrior};
use sinew_core::lanes::{Block, Isa, LANES, get_lane};
use sinew_core::random::BlockRng;
use sinew_core::transition::{GradTransition, MotionModel, Transition};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The noise of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepNoise {
    /// The variance that the process predicts.
    Predicted,
    /// Standard deviations of the coordinates.
    Fixed(Vec<f64>),
}

/// Motion of the latents of a root.
#[derive(Clone, Debug)]
pub struct LatentMotion {
    mapping: Arc<Mapping>,
    noise: StepNoise,
    isa: Isa,
}

impl LatentMotion {
    /// Of a root of a model with dynamics.
    ///
    /// # Errors
    /// [`Error::NoDynamics`], [`Error::Shape`], [`Error::OutOfRange`] or [`Error::Singular`].
    pub fn new(model: &LatentModel, root: usize, noise: StepNoise, isa: Isa) -> Result<Self, Error> {
        let RootPrior::Dynamics { covariance, .. } = &model.prior else { return Err(Error::NoDynamics) };
        let node = &model.nodes[root];
        if let StepNoise::Fixed(sd) = &noise {
            if sd.len() != node.dim {
                return Err(Error::Shape { name: "noise of a latent step", found: sd.len(), expected: node.dim });
            }
            crate::ranges::positive("noise of a latent step", sd)?;
        }
        let (mut inputs, mut outputs, mut start) = (Vec::new(), Vec::new(), 0);
        for length in model.sequences_within(&node.rows) {
            let rows = &node.latents[start * node.dim..(start + length) * node.dim];
            inputs.extend_from_slice(&rows[..rows.len() - node.dim]);
            outputs.extend_from_slice(&rows[node.dim..]);
            start += length;
        }
        let (scale, mean) = (vec![1.0; node.dim], vec![0.0; node.dim]);
        let mapping = Arc::new(Mapping::fit(*covariance, &inputs, node.dim, &outputs, scale, mean)?);
        Ok(Self { mapping, noise, isa })
    }

    /// The process of the dynamics: φ and s_X².
    pub(crate) fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// φ(x).
    #[must_use]
    pub fn mean(&self, x: &[f64]) -> Vec<f64> {
        self.mapping.mean_at(x)
    }

    /// Variances of the coordinates of a step from x.
    #[must_use]
    pub fn variances(&self, x: &[f64]) -> Vec<f64> {
        match &self.noise {
            StepNoise::Predicted => vec![self.mapping.variance_at(x) + self.mapping.noise(); x.len()],
            StepNoise::Fixed(sd) => sd.iter().map(|sd| sd * sd).collect(),
        }
    }
}

impl MotionModel for LatentMotion {
    fn dim(&self) -> usize {
        self.mapping.dim()
    }
}

impl Transition for LatentMotion {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let dim = self.mapping.dim();
        let mut ws = vec![Block::ZERO; self.mapping.workspace() + dim];
        let (noise, ws) = ws.split_at_mut(dim);
        rng.fill_normal(self.isa, noise);
        self.mapping.mean_block(previous, self.isa, next, ws);
        let predicted = match &self.noise {
            StepNoise::Predicted => self.mapping.variance_block(previous, self.isa, ws),
            StepNoise::Fixed(_) => Block::ZERO,
        };
        for (j, (x, z)) in next.iter_mut().zip(noise).enumerate() {
            for lane in 0..LANES {
                let sd = match &self.noise {
                    StepNoise::Predicted => (predicted.0[lane] + self.mapping.noise()).sqrt(),
                    StepNoise::Fixed(sd) => sd[j],
                };
                x.0[lane] += sd * z.0[lane];
            }
        }
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let steps = self.mean(previous).into_iter().zip(next).zip(self.variances(previous));
        steps.map(|((mean, x), variance)| -0.5 * ((x - mean).powi(2) / variance + (TAU * variance).ln())).sum()
    }
}

impl GradTransition for LatentMotion {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        let steps = self.mean(previous).into_iter().zip(next).zip(self.variances(previous));
        grad.iter_mut().zip(steps).for_each(|(g, ((mean, x), variance))| *g = (mean - x) / variance);
        self.log_density(previous, next)
    }
}

/// A path of latents from a start, drawn from the dynamics, or along their mean where there is no randomness: rows of q, the start first.
#[must_use]
pub fn path(motion: &LatentMotion, start: &[f64], steps: usize, mut rng: Option<&mut BlockRng>) -> Vec<f64> {
    let mut path = start.to_vec();
    let mut latent = start.to_vec();
    for _ in 0..steps {
        latent = match &mut rng {
            None => motion.mean(&latent),
            Some(rng) => {
                let previous: Vec<Block> = latent.iter().map(|&x| Block::splat(x)).collect();
                let mut next = vec![Block::ZERO; latent.len()];
                motion.sample_block(&previous, &mut next, rng);
                get_lane(&next, 0, &mut latent);
                latent
            }
        };
        path.extend_from_slice(&latent);
    }
    path
}

/// Half of the largest change of each coordinate of a node's latents between consecutive rows of a sequence: the trackers' standard deviation of a step.
#[must_use]
pub fn step_sd(model: &LatentModel, node: usize) -> Vec<f64> {
    let own = &model.nodes[node];
    let (mut largest, mut start) = (vec![0.0_f64; own.dim], 0);
    for length in model.sequences_within(&own.rows) {
        for row in start + 1..start + length {
            let changes = own.latent(row).iter().zip(own.latent(row - 1));
            largest.iter_mut().zip(changes).for_each(|(most, (a, b))| *most = most.max((a - b).abs()));
        }
        start += length;
    }
    largest.into_iter().map(|most| 0.5 * most.max(1e-9)).collect()
}
