//! The smallest target: a Gaussian with independent coordinates, as a lane leaf and as a plain density.

use crate::density::{GaussNewton, GradLogDensity, LaneDensity, LaneGaussNewton, LogDensity};
use crate::lanes::{Block, Real};

/// `log p = −½ Σ precision_j (x_j − centre_j)²`, without constant.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadratic {
    /// Mean.
    pub centre: Vec<f64>,
    /// Inverse variances.
    pub precision: Vec<f64>,
}

impl LaneDensity for Quadratic {
    fn dim(&self) -> usize {
        self.centre.len()
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
        let mut sum = V::splat(0.0);
        for j in 0..self.centre.len() {
            let e = V::load(&x[j]) - V::splat(self.centre[j]);
            let force = e * V::splat(-self.precision[j]);
            sum = force.fma(e, sum);
            if GRAD {
                force.store(&mut grad[j]);
            }
        }
        sum * V::splat(0.5)
    }
}

impl LaneGaussNewton for Quadratic {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, _x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (d, &precision) in diagonal.iter_mut().zip(&self.precision) {
            V::splat(precision).store(d);
        }
    }
}

impl LogDensity for Quadratic {
    fn dim(&self) -> usize {
        self.centre.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.centre).zip(&self.precision).map(|((x, c), p)| -0.5 * p * (x - c) * (x - c)).sum()
    }
}

impl GradLogDensity for Quadratic {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        for (j, g) in grad.iter_mut().enumerate() {
            *g = -self.precision[j] * (x[j] - self.centre[j]);
        }
        LogDensity::log_density(self, x)
    }
}

impl GaussNewton for Quadratic {
    fn gauss_newton_diagonal_block(&self, _x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        for (d, &precision) in diagonal.iter_mut().zip(&self.precision) {
            *d = Block::splat(precision);
        }
    }
}
