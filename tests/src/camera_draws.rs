//! Exact draws from the posterior of the camera point, by rejection.

use crate::camera_point::CameraPoint;
use sinew::core::density::{GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::BlockRng;
use sinew::dynamics::gaussian::Gaussian;
use sinew_invariance::draws::uniform;
use sinew_invariance::targets::ExactTarget;

/// The posterior of the camera point, drawn by rejection from a Gaussian that is 1.3 times as wide.
#[derive(Clone)]
pub struct Seen<'a> {
    point: &'a CameraPoint,
    envelope: Lanes<Gaussian>,
    /// Largest logarithm of target over envelope, on a grid of ±8 deviations, and a little more.
    bound: f64,
}

impl<'a> Seen<'a> {
    /// Finds the bound of the rejection.
    ///
    /// # Panics
    /// Where the stored covariance is not one.
    #[must_use]
    pub fn new(point: &'a CameraPoint) -> Self {
        let wide: Vec<f64> = point.moments.covariance.iter().map(|c| 1.69 * c).collect();
        let leaf = Gaussian::new(point.mode.clone(), &wide).expect("positive definite");
        let envelope = Lanes { leaf, isa: Isa::best() };
        let target = point.target();
        let mut bound = f64::NEG_INFINITY;
        for index in 0..33_usize.pow(3) {
            let x: Vec<f64> = (0..3)
                .map(|j| {
                    let step = (index / 33_usize.pow(j as u32) % 33) as f64 / 2.0 - 8.0;
                    point.mode[j] + step * point.moments.covariance[4 * j].sqrt()
                })
                .collect();
            bound = bound.max(target.log_density(&x) - envelope.log_density(&x));
        }
        Self { point, envelope, bound: bound + 0.05 }
    }
}

impl LogDensity for Seen<'_> {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.point.target().log_density(x)
    }
}

impl GradLogDensity for Seen<'_> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.point.target().log_density_grad(x, grad)
    }
}

impl ExactTarget for Seen<'_> {
    fn draw(&self, rng: &mut BlockRng) -> Vec<f64> {
        let mut proposed = vec![Block::ZERO; 3];
        loop {
            self.envelope.leaf.sample_block(Isa::baseline(), &mut proposed, rng);
            let x: Vec<f64> = proposed.iter().map(|b| b.0[0]).collect();
            let ratio = self.log_density(&x) - self.envelope.log_density(&x) - self.bound;
            assert!(ratio <= 0.0, "the envelope covers the target");
            if uniform(rng).ln() < ratio {
                return x;
            }
        }
    }
}
