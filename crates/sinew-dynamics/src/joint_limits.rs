//! Limits of joints as a soft factor of a prior.
//!
//! log π(x) = −½ Σ_j (e_j / σ)², with e_j the distance of coordinate j outside its range: flat inside, half a Gaussian beyond each end. The gradient is continuous, the curvature 1/σ² outside and 0 inside.
//!
//! σ says how far people differ in their ranges and how far the zeros of bodies are from a goniometer's; [`SIGMA_RAD`] is our choice. Not normalised.

use crate::joint_ranges::JointRanges;
use sinew_core::density::{LaneDensity, LaneGaussNewton};
use sinew_core::lanes::Real;

/// σ, radians: 10°.
pub const SIGMA_RAD: f64 = 10.0 * core::f64::consts::PI / 180.0;

/// The factor.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits {
    dim: usize,
    /// Coordinate, its range, 1/σ².
    limits: Vec<(usize, [f64; 2], f64)>,
}

impl JointLimits {
    /// The factor of some ranges with one σ, radians.
    #[must_use]
    pub fn new(ranges: &JointRanges, sigma: f64) -> Self {
        let limit = |(j, range): (usize, &Option<[f64; 2]>)| range.map(|range| (j, range, 1.0 / (sigma * sigma)));
        Self { dim: ranges.dim(), limits: ranges.all().iter().enumerate().filter_map(limit).collect() }
    }

    /// How far a coordinate is beyond its range, with its sign.
    #[inline(always)]
    fn beyond<V: Real>(x: V, [low, high]: [f64; 2]) -> V {
        let zero = V::splat(0.0);
        (x - V::splat(high)).max(zero) - (V::splat(low) - x).max(zero)
    }
}

impl LaneDensity for JointLimits {
    fn dim(&self) -> usize {
        self.dim
    }

    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], _ws: &mut [V::Mem]) -> V {
        if GRAD {
            for g in &mut grad[..self.dim] {
                V::splat(0.0).store(g);
            }
        }
        let mut sum = V::splat(0.0);
        for &(j, range, precision) in &self.limits {
            let beyond = Self::beyond(V::load(&x[j]), range);
            let force = beyond * V::splat(-precision);
            sum = force.fma(beyond, sum);
            if GRAD {
                force.store(&mut grad[j]);
            }
        }
        sum * V::splat(0.5)
    }
}

impl LaneGaussNewton for JointLimits {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for d in &mut diagonal[..self.dim] {
            V::splat(0.0).store(d);
        }
        for &(j, range, precision) in &self.limits {
            let beyond = Self::beyond(V::load(&x[j]), range);
            let (precision, zero) = (V::splat(precision), V::splat(0.0));
            (beyond * beyond).select_gt(0.0, precision, zero).store(&mut diagonal[j]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{GaussNewton as _, Lanes, LogDensity as _};
    use sinew_core::lanes::{Block, Isa};

    #[test]
    fn the_factor_is_flat_inside_and_half_a_gaussian_outside() {
        let ranges = JointRanges::new(vec![None, Some([-0.5, 1.0]), Some([0.0, 2.0])]).unwrap();
        for isa in Isa::available() {
            let density = Lanes { leaf: JointLimits::new(&ranges, 0.1), isa };
            let log = |x: [f64; 3]| density.log_density(&x);
            assert_eq!(log([99.0, 1.0, 0.0]), 0.0);
            assert!((log([0.0, 1.2, 0.5]) + 2.0).abs() < 1e-12 && (log([0.0, 0.0, -0.1]) + 0.5).abs() < 1e-12);
            assert!((log([0.0, -0.8, 2.1]) + 5.0).abs() < 1e-12);
            let mut diagonal = vec![Block::ZERO; 3];
            density.gauss_newton_diagonal_block(&[9.0, 1.5, 1.0].map(Block::splat), &mut diagonal, &mut []);
            assert_eq!(diagonal[0], Block::ZERO);
            assert!((diagonal[1].0[3] - 100.0).abs() < 1e-9 && diagonal[2] == Block::ZERO);
        }
    }
}
