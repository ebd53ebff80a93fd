//! Log density of a body's state given detected keypoints, with gradient and curvature, over lanes.
//!
//! [`KeypointModel`](crate::KeypointModel) has the formulas; this is what a frame is bound to. Sightings of a point are multiplied before one logarithm is taken of them.

use crate::camera::MIN_DEPTH_M;
use crate::lane_projection::{LaneCamera, LaneCameras};
use crate::lens::Distort;
use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton};
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::Real;
use std::sync::Arc;

/// Shape of a sighting's density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// A Gaussian core; with probability `outlier` the detection lies anywhere in the image.
    OutlierFloor {
        /// Probability of a gross outlier, in (0, 1).
        outlier: f64,
    },
    /// A Student t distribution in two dimensions.
    StudentT {
        /// Degrees of freedom ν.
        degrees: f64,
    },
}

/// One keypoint in one camera.
#[derive(Clone, Debug)]
pub(crate) struct Sighting {
    pub camera: usize,
    /// Detection minus bias minus principal point, pixels.
    pub pixel: [f64; 2],
    /// 1/s².
    pub information: f64,
    /// Outlier floor relative to the core's peak; with Student t, 1/(ν s²).
    pub shape: f64,
}

/// The likelihood of one frame of keypoints.
#[derive(Clone, Debug)]
pub struct KeypointLikelihood {
    pub(crate) plan: Arc<Plan>,
    pub(crate) cameras: LaneCameras,
    pub(crate) sightings: Vec<Sighting>,
    /// Sightings of point k in the plan's order: `sightings[first[k]..first[k + 1]]`.
    pub(crate) first: Vec<usize>,
    pub(crate) noise: Noise,
    pub(crate) constant: f64,
}

/// Factors of the likelihood whose product cannot underflow before its logarithm is taken.
const FACTORS: usize = 16;

impl LaneDensity for KeypointLikelihood {
    fn dim(&self) -> usize {
        self.plan.dof()
    }

    fn workspace(&self) -> usize {
        self.plan.workspace()
    }

    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        match &self.cameras {
            LaneCameras::Brown(cameras) => self.sum::<V, _, GRAD>(cameras, x, grad, ws),
            LaneCameras::Mixed(cameras) => self.sum::<V, _, GRAD>(cameras, x, grad, ws),
        }
    }
}

impl KeypointLikelihood {
    /// Whether no camera sees any point.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.sightings.is_empty()
    }

    #[inline(always)]
    fn sum<V: Real, L: Distort, const GRAD: bool>(
        &self,
        cameras: &[LaneCamera<L>],
        x: &[V::Mem],
        grad: &mut [V::Mem],
        ws: &mut [V::Mem],
    ) -> V {
        let mut visitor = LogDensities::<'_, V, L, GRAD> { likelihood: self, cameras, value: V::splat(self.constant) };
        self.plan.walk::<V, GRAD>(x, grad, ws, &mut visitor);
        visitor.value
    }
}

/// Sum of the log densities of the sightings.
struct LogDensities<'a, V, L, const GRAD: bool> {
    likelihood: &'a KeypointLikelihood,
    cameras: &'a [LaneCamera<L>],
    value: V,
}

impl<V: Real, L: Distort, const GRAD: bool> Visit<V> for LogDensities<'_, V, L, GRAD> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: [V; 3]) -> [V; 3] {
        let s = |x: f64| V::splat(x);
        let mut force = [s(0.0); 3];
        for sightings in self.likelihood.sightings_of(k).chunks(FACTORS) {
            let mut product = s(1.0);
            for sighting in sightings {
                let camera = &self.cameras[sighting.camera];
                let shown = camera.show::<V, GRAD>(p);
                let [r0, r1] = camera.residual(&shown, sighting.pixel);
                let square = r1.fma(r1, r0 * r0);
                let weight;
                match self.likelihood.noise {
                    Noise::OutlierFloor { .. } => {
                        let core = exp(square * s(-0.5 * sighting.information));
                        let core = shown.depth.select_gt(MIN_DEPTH_M, core, s(0.0));
                        let total = core + s(sighting.shape);
                        product = product * total;
                        weight = core / total * s(sighting.information);
                    }
                    Noise::StudentT { degrees } => {
                        let spread = square.fma(s(sighting.shape), s(1.0));
                        let spread = shown.depth.select_gt(MIN_DEPTH_M, spread, s(1e6 / degrees));
                        product = product * spread;
                        let strength = s((degrees + 2.0) * sighting.shape) / spread;
                        weight = shown.depth.select_gt(MIN_DEPTH_M, strength, s(0.0));
                    }
                }
                if GRAD {
                    let g = camera.pull(&shown, [weight * r0, weight * r1]);
                    force = [force[0] + g[0], force[1] + g[1], force[2] + g[2]];
                }
            }
            let exponent = match self.likelihood.noise {
                Noise::OutlierFloor { .. } => 1.0,
                Noise::StudentT { degrees } => -0.5 * (degrees + 2.0),
            };
            self.value = ln(product).fma(s(exponent), self.value);
        }
        force
    }
}

impl KeypointLikelihood {
    /// How much of a sighting's pull is left: 1 at its centre, 0 where it counts as an outlier.
    #[inline(always)]
    fn share<V: Real>(&self, sighting: &Sighting, [r0, r1]: [V; 2], depth: V) -> V {
        let square = r1.fma(r1, r0 * r0);
        let share = match self.noise {
            Noise::OutlierFloor { .. } => {
                let core = exp(square * V::splat(-0.5 * sighting.information));
                core / (core + V::splat(sighting.shape))
            }
            Noise::StudentT { degrees } => {
                V::splat((degrees + 2.0) / degrees) / square.fma(V::splat(sighting.shape), V::splat(1.0))
            }
        };
        depth.select_gt(MIN_DEPTH_M, share, V::splat(0.0))
    }

    /// Sightings of point k in the plan's order.
    #[inline(always)]
    fn sightings_of(&self, k: usize) -> &[Sighting] {
        &self.sightings[self.first[k]..self.first[k + 1]]
    }
}

/// Information of sightings on their points' positions: each in full, outlier or not, or `WEIGHTED` by the share of its core at the state.
struct Information<'a, L, const WEIGHTED: bool> {
    likelihood: &'a KeypointLikelihood,
    cameras: &'a [LaneCamera<L>],
}

impl<V: Real, L: Distort, const WEIGHTED: bool> Inform<V> for Information<'_, L, WEIGHTED> {
    #[inline(always)]
    fn information(&self, k: usize, p: [V; 3]) -> [V; 6] {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let mut m = [zero; 6];
        for sighting in self.likelihood.sightings_of(k) {
            let camera = &self.cameras[sighting.camera];
            let shown = camera.show::<V, true>(p);
            let mut information = shown.depth.select_gt(MIN_DEPTH_M, V::splat(sighting.information), zero);
            if WEIGHTED {
                information =
                    information * self.likelihood.share(sighting, camera.residual(&shown, sighting.pixel), shown.depth);
            }
            for e in [[one, zero], [zero, one]] {
                let g = camera.pull(&shown, e);
                let w = [information * g[0], information * g[1], information * g[2]];
                m = [
                    w[0].fma(g[0], m[0]),
                    w[0].fma(g[1], m[1]),
                    w[0].fma(g[2], m[2]),
                    w[1].fma(g[1], m[3]),
                    w[1].fma(g[2], m[4]),
                    w[2].fma(g[2], m[5]),
                ];
            }
        }
        m
    }
}

impl KeypointLikelihood {
    #[inline(always)]
    fn matrix<V: Real, const WEIGHTED: bool>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        match &self.cameras {
            LaneCameras::Brown(cameras) => {
                let information = Information::<'_, _, WEIGHTED> { likelihood: self, cameras };
                self.plan.gauss_newton::<V>(x, ws, matrix, &information);
            }
            LaneCameras::Mixed(cameras) => {
                let information = Information::<'_, _, WEIGHTED> { likelihood: self, cameras };
                self.plan.gauss_newton::<V>(x, ws, matrix, &information);
            }
        }
    }
}

impl LaneGaussNewton for KeypointLikelihood {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], ws: &mut [V::Mem]) {
        match &self.cameras {
            LaneCameras::Brown(cameras) => {
                let information = Information::<'_, _, false> { likelihood: self, cameras };
                self.plan.gauss_newton_diagonal::<V>(x, ws, diagonal, &information);
            }
            LaneCameras::Mixed(cameras) => {
                let information = Information::<'_, _, false> { likelihood: self, cameras };
                self.plan.gauss_newton_diagonal::<V>(x, ws, diagonal, &information);
            }
        }
    }

    #[inline(always)]
    fn gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.matrix::<V, false>(x, matrix, ws);
    }

    #[inline(always)]
    fn weighted_gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.matrix::<V, true>(x, matrix, ws);
    }

    /// Every sighting's s is multiplied; its floor keeps its height.
    fn broadened(&self, factor: f64) -> Option<Self> {
        let square = factor * factor;
        let mut broad = self.clone();
        for sighting in &mut broad.sightings {
            sighting.information /= square;
            match self.noise {
                Noise::OutlierFloor { .. } => sighting.shape *= square,
                Noise::StudentT { .. } => sighting.shape /= square,
            }
        }
        broad.constant -= square.ln() * self.sightings.len() as f64;
        Some(broad)
    }
}
