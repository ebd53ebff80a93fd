//! A small target and a small decoder: a Gaussian with independent coordinates, and a curved sheet.

use crate::decode::LaneDecode;
use crate::density::{GaussNewton, GradLogDensity, LaneDensity, LaneGaussNewton, LogDensity};
use crate::elementary::sin_cos;
use crate::lanes::Real;

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
    fn gauss_newton_diagonal(&self, _x: &[f64], diagonal: &mut [f64]) {
        diagonal.copy_from_slice(&self.precision);
    }
}

/// A sheet rolled to a cylinder and twisted: `(u, v) ↦ (r sin(u/r), r − r cos(u/r), v, t u v)`, one-to-one for |u| < π r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Radius r of the roll, not 0.
    pub radius: f64,
    /// Twist t.
    pub twist: f64,
}

impl LaneDecode for Sheet {
    fn source_dim(&self) -> usize {
        2
    }
    fn target_dim(&self) -> usize {
        4
    }
    #[inline(always)]
    fn decode<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem], _ws: &mut [V::Mem]) {
        let (u, v, radius) = (V::load(&x[0]), V::load(&x[1]), V::splat(self.radius));
        let (sin, cos) = sin_cos(u * V::splat(1.0 / self.radius));
        (radius * sin).store(&mut out[0]);
        cos.fnma(radius, radius).store(&mut out[1]);
        v.store(&mut out[2]);
        (u * v * V::splat(self.twist)).store(&mut out[3]);
    }
    #[inline(always)]
    fn pullback<V: Real>(&self, x: &[V::Mem], grad_out: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) {
        let (u, v) = (V::load(&x[0]), V::load(&x[1]));
        let (sin, cos) = sin_cos(u * V::splat(1.0 / self.radius));
        let twisted = V::load(&grad_out[3]) * V::splat(self.twist);
        let rolled = cos.fma(V::load(&grad_out[0]), sin * V::load(&grad_out[1]));
        v.fma(twisted, rolled).store(&mut grad[0]);
        u.fma(twisted, V::load(&grad_out[2])).store(&mut grad[1]);
    }

    /// None on the axis of the cylinder, which is as near to every u.
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        let (across, up) = (decoded[0] / self.radius, 1.0 - decoded[1] / self.radius);
        let state = vec![self.radius * across.atan2(up), decoded[2]];
        (across.hypot(up) > 1e-9 && state.iter().all(|x| x.is_finite())).then_some(state)
    }
}
