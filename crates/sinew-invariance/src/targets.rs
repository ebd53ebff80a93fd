//! Targets with exact draws, for tests of samplers.
//!
//! | target | what it tries |
//! |---|---|
//! | [`GaussianTarget`] | correlation and scale in any dimension |
//! | [`MixtureTarget`] | several modes; with equal means, heavy tails |
//! | [`Banana`] | curvature that changes along the way |
//! | [`HalfLine`] | a hard edge at which the density is largest |
//! | [`Truncated`] | a cliff to −∞, or a region where the density is NaN |

use crate::draws::{normals, uniform};
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::random::BlockRng;
use std::f64::consts::TAU;

/// A density from which independent draws can be taken.
pub trait ExactTarget: GradLogDensity {
    /// A draw.
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64>;
}

/// N(m, L Lᵀ) in any dimension, with its normalising constant.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianTarget {
    mean: Vec<f64>,
    factor: Vec<Vec<f64>>,
    constant: f64,
}

impl GaussianTarget {
    /// From its mean and the rows of the lower triangle L, row i with i + 1 entries and a positive last one.
    ///
    /// # Panics
    /// When the shapes do not fit or a diagonal entry is not positive.
    #[must_use]
    pub fn new(mean: Vec<f64>, factor: Vec<Vec<f64>>) -> Self {
        assert_eq!(mean.len(), factor.len(), "one row of the factor for each coordinate");
        for (i, row) in factor.iter().enumerate() {
            assert!(row.len() == i + 1 && row[i] > 0.0, "row {i} of a lower triangle with positive diagonal");
        }
        let log_det: f64 = factor.iter().enumerate().map(|(i, row)| row[i].ln()).sum();
        let constant = -0.5 * mean.len() as f64 * TAU.ln() - log_det;
        Self { mean, factor, constant }
    }

    /// N(0, 1) in `dim` dimensions.
    #[must_use]
    pub fn standard(dim: usize) -> Self {
        Self::scaled(&vec![1.0; dim])
    }

    /// Mean 0 and independent coordinates with these standard deviations.
    ///
    /// # Panics
    /// When one is not positive.
    #[must_use]
    pub fn scaled(sd: &[f64]) -> Self {
        let row = |(i, &s): (usize, &f64)| (0..=i).map(|j| if i == j { s } else { 0.0 }).collect();
        Self::new(vec![0.0; sd.len()], sd.iter().enumerate().map(row).collect())
    }

    /// Mean 0, standard deviation 1 and correlation `rho` between any two coordinates, 0 ≤ `rho` < 1.
    ///
    /// # Panics
    /// When `rho` lies outside.
    #[must_use]
    pub fn equicorrelated(dim: usize, rho: f64) -> Self {
        assert!((0.0..1.0).contains(&rho), "0 ≤ rho < 1");
        let mut factor: Vec<Vec<f64>> = Vec::with_capacity(dim);
        for _ in 0..dim {
            let mut row: Vec<f64> = Vec::with_capacity(dim);
            for earlier in &factor {
                let known: f64 = row.iter().zip(earlier).map(|(a, b)| a * b).sum();
                row.push((rho - known) / earlier[row.len()]);
            }
            row.push((1.0 - row.iter().map(|a| a * a).sum::<f64>()).sqrt());
            factor.push(row);
        }
        Self::new(vec![0.0; dim], factor)
    }

    /// Mean.
    #[must_use]
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Entry of the covariance L Lᵀ.
    #[must_use]
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        self.factor[i].iter().zip(&self.factor[j]).map(|(a, b)| a * b).sum()
    }
}

impl LogDensity for GaussianTarget {
    fn dim(&self) -> usize {
        self.mean.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
}

impl GradLogDensity for GaussianTarget {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let d = x.len();
        let mut z = vec![0.0; d];
        for (i, row) in self.factor.iter().enumerate() {
            let known: f64 = row.iter().zip(&z[..i]).map(|(l, z)| l * z).sum();
            z[i] = (x[i] - self.mean[i] - known) / row[i];
        }
        for i in (0..d).rev() {
            let known: f64 = (i + 1..d).map(|k| self.factor[k][i] * grad[k]).sum();
            grad[i] = (-z[i] - known) / self.factor[i][i];
        }
        self.constant - 0.5 * z.iter().map(|z| z * z).sum::<f64>()
    }
}

impl ExactTarget for GaussianTarget {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        let z = normals(self.mean.len(), rng);
        let image = |row: &Vec<f64>| row.iter().zip(&z).map(|(l, z)| l * z).sum::<f64>();
        self.mean.iter().zip(&self.factor).map(|(m, row)| m + image(row)).collect()
    }
}

/// A mixture of Gaussians.
#[derive(Clone, Debug, PartialEq)]
pub struct MixtureTarget {
    weights: Vec<f64>,
    components: Vec<GaussianTarget>,
}

impl MixtureTarget {
    /// From weights, scaled to sum to 1, and components of one dimension.
    ///
    /// # Panics
    /// When there is no component, the numbers or dimensions differ, or a weight is not positive.
    #[must_use]
    pub fn new(weights: Vec<f64>, components: Vec<GaussianTarget>) -> Self {
        assert!(!components.is_empty() && weights.len() == components.len(), "a weight for each component");
        assert!(weights.iter().all(|&w| w > 0.0 && w.is_finite()), "positive weights");
        assert!(components.iter().all(|c| c.dim() == components[0].dim()), "one dimension");
        let sum: f64 = weights.iter().sum();
        Self { weights: weights.iter().map(|w| w / sum).collect(), components }
    }
}

impl LogDensity for MixtureTarget {
    fn dim(&self) -> usize {
        self.components[0].dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
}

impl GradLogDensity for MixtureTarget {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let parts: Vec<(f64, Vec<f64>)> = self
            .weights
            .iter()
            .zip(&self.components)
            .map(|(w, component)| {
                let mut own = vec![0.0; x.len()];
                (w.ln() + component.log_density_grad(x, &mut own), own)
            })
            .collect();
        let most = parts.iter().map(|p| p.0).fold(f64::NEG_INFINITY, f64::max);
        let sum: f64 = parts.iter().map(|p| (p.0 - most).exp()).sum();
        grad.fill(0.0);
        for (value, own) in &parts {
            let share = (value - most).exp() / sum;
            grad.iter_mut().zip(own).for_each(|(g, own)| *g += share * own);
        }
        most + sum.ln()
    }
}

impl ExactTarget for MixtureTarget {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        let mut left = uniform(rng);
        let chosen = self.weights.iter().position(|w| {
            left -= w;
            left < 0.0
        });
        self.components[chosen.unwrap_or(self.components.len() - 1)].draw(rng)
    }
}

/// x₀ ~ N(0, s²), x₁ ~ N(b (x₀² − s²), 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Banana {
    /// s.
    pub sd: f64,
    /// b.
    pub bend: f64,
}

impl LogDensity for Banana {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 2])
    }
}

impl GradLogDensity for Banana {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let (a, v) = (x[0], self.sd * self.sd);
        let off = x[1] - self.bend * (a * a - v);
        grad[0] = -a / v + 2.0 * off * self.bend * a;
        grad[1] = -off;
        -0.5 * (a * a / v + off * off) - TAU.ln() - self.sd.ln()
    }
}

impl ExactTarget for Banana {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        let z = normals(2, rng);
        let a = self.sd * z[0];
        vec![a, z[1] + self.bend * (a * a - self.sd * self.sd)]
    }
}

/// Independent exponential coordinates on x ≥ 0; −∞ below.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfLine {
    /// Rate of each.
    pub rate: Vec<f64>,
}

impl LogDensity for HalfLine {
    fn dim(&self) -> usize {
        self.rate.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
}

impl GradLogDensity for HalfLine {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.iter_mut().zip(&self.rate).for_each(|(g, r)| *g = -r);
        let one = |(x, r): (&f64, &f64)| if *x < 0.0 { f64::NEG_INFINITY } else { r.ln() - r * x };
        x.iter().zip(&self.rate).map(one).sum()
    }
}

impl ExactTarget for HalfLine {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        self.rate.iter().map(|r| -uniform(rng).ln() / r).collect()
    }
}

/// A Gaussian cut at x₀ = `edge`: beyond it the log density is `beyond`. The constant is that of the whole Gaussian.
#[derive(Clone, Debug, PartialEq)]
pub struct Truncated {
    /// The Gaussian.
    pub whole: GaussianTarget,
    /// Where it ends. Draws are by rejection: leave a good part of the whole.
    pub edge: f64,
    /// −∞ for a cliff; NaN for a region where a density breaks down, which a sampler must treat as −∞.
    pub beyond: f64,
}

impl LogDensity for Truncated {
    fn dim(&self) -> usize {
        self.whole.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
}

impl GradLogDensity for Truncated {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        if x[0] > self.edge {
            grad.fill(self.beyond);
            return self.beyond;
        }
        self.whole.log_density_grad(x, grad)
    }
}

impl ExactTarget for Truncated {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        loop {
            let x = self.whole.draw(rng);
            if x[0] <= self.edge {
                return x;
            }
        }
    }
}
