//! Linear-Gaussian motion s_t = A s_{t−1} + N(0, Q), the model to check trackers on.
//!
//! With a linear observation every filter and smoother of it has a closed form (Kalman 1960).
//!
//! As [`Predict`] it maps the moments of one frame's posterior to N(A m, A C Aᵀ + Q), which is exact here.

use crate::Error;
use crate::factor::root;
use crate::gaussian::Gaussian;
use crate::linear_motion::{self, add_product};
use crate::prior::Prior;
use sinew_core::density::{Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::BlockRng;
use sinew_core::transition::{Cloud, MotionModel, Predict, Transition};

/// The model: A, Q and the covariance P₀ of the first frame's state about its centre, all d × d, row after row.
#[derive(Clone, Debug)]
pub struct LinearGaussian {
    dim: usize,
    matrix: Vec<f64>,
    noise: Vec<f64>,
    noise_root: Vec<f64>,
    noise_density: Lanes<Gaussian>,
    initial: Vec<f64>,
    initial_root: Vec<f64>,
}

impl LinearGaussian {
    /// Validates and factors the matrices. P₀ may be semi-definite, even 0 (a filter with gradients then refuses to start); Q must have a density.
    ///
    /// # Errors
    /// As [`crate::factor`].
    pub fn new(dim: usize, matrix: Vec<f64>, noise: Vec<f64>, initial: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        if matrix.len() != dim * dim {
            return Err(Error::Shape { name: "A", found: matrix.len(), expected: dim * dim });
        }
        if let Some(index) = matrix.iter().position(|a| !a.is_finite()) {
            return Err(Error::OutOfRange { name: "A", index, value: matrix[index], expected: "must be finite" });
        }
        Ok(Self {
            dim,
            noise_root: root("Q", &noise, dim)?,
            noise_density: Lanes { leaf: Gaussian::new(vec![0.0; dim], &noise)?, isa },
            initial_root: root("P0", &initial, dim)?,
            matrix,
            noise,
            initial,
        })
    }

    /// Q, row after row.
    #[must_use]
    pub fn noise(&self) -> &[f64] {
        &self.noise
    }
}

impl MotionModel for LinearGaussian {
    fn dim(&self) -> usize {
        self.dim
    }
}

impl Transition for LinearGaussian {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; self.dim];
        rng.fill_normal(self.noise_density.isa, &mut noise);
        next.fill(Block::ZERO);
        add_product(&self.matrix, previous, next);
        add_product(&self.noise_root, &noise, next);
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; self.dim];
        rng.fill_normal(self.noise_density.isa, &mut noise);
        for (x, &c) in next.iter_mut().zip(centre) {
            *x = Block::splat(c);
        }
        add_product(&self.initial_root, &noise, next);
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let rows = self.matrix.chunks_exact(self.dim);
        let step = |(row, n): (&[f64], &f64)| n - row.iter().zip(previous).map(|(a, p)| a * p).sum::<f64>();
        self.noise_density.log_density(&rows.zip(next).map(step).collect::<Vec<_>>())
    }
}

impl Predict for LinearGaussian {
    type Prior = Prior;
    type Error = Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Error> {
        let predicted = linear_motion::predict(&self.matrix, &self.noise, cloud.moments);
        let leaf = Gaussian::new(predicted.mean, &predicted.covariance)?;
        Ok(Prior::Gaussian(Lanes { leaf, isa: self.noise_density.isa }))
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Error> {
        let leaf = Gaussian::new(centre.to_vec(), &self.initial)?;
        Ok(Prior::Gaussian(Lanes { leaf, isa: self.noise_density.isa }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::random::Stage;

    fn model() -> LinearGaussian {
        let (a, q, p0) = (vec![1.0, 0.1, 0.0, 0.9], vec![0.2, 0.1, 0.1, 0.3], vec![0.0; 4]);
        LinearGaussian::new(2, a, q, p0, Isa::best()).expect("valid")
    }

    #[test]
    fn density_is_that_of_the_step() {
        let (previous, next) = ([1.0, 2.0], [1.5, 1.5]);
        let exact = model().noise_density.log_density(&[1.5 - 1.2, 1.5 - 1.8]);
        assert!((Transition::log_density(&model(), &previous, &next) - exact).abs() < 1e-14);
    }

    #[test]
    fn draws_have_the_mean_and_covariance() {
        let m = model();
        let mut rng = Stage::new(2, "linear").whole();
        let previous = [Block::splat(1.0), Block::splat(2.0)];
        let mut next = [Block::ZERO; 2];
        let (mut mean, mut cross, n) = (0.0, 0.0, 40_000.0);
        for _ in 0..5000 {
            m.sample_block(&previous, &mut next, &mut rng);
            mean += next[0].0.iter().sum::<f64>() / n;
            cross += (0..8).map(|l| (next[0].0[l] - 1.2) * (next[1].0[l] - 1.8)).sum::<f64>() / n;
        }
        assert!((mean - 1.2).abs() < 4.5 * (0.2_f64 / n).sqrt(), "{mean} against 1.2");
        assert!((cross - 0.1).abs() < 4.5 * (0.07_f64 / n).sqrt(), "{cross} against 0.1");
    }

    #[test]
    fn a_certain_start_can_be_drawn_but_has_no_density() {
        let mut next = [Block::ZERO; 2];
        model().sample_initial_block(&[3.0, 4.0], &mut next, &mut Stage::new(1, "start").whole());
        assert_eq!(next, [Block::splat(3.0), Block::splat(4.0)]);
        assert!(matches!(model().initial(&[3.0, 4.0]), Err(Error::Singular { .. })));
        let bad = LinearGaussian::new(2, vec![1.0; 4], vec![1.0, 2.0, 2.0, 1.0], vec![0.0; 4], Isa::best());
        assert!(matches!(bad, Err(Error::Indefinite { name: "Q", .. })));
    }
}
