//! Log density of a body's state given detected keypoints, with gradient and curvature, over lanes.
//!
//! [`KeypointModel`](crate::KeypointModel) has the formulas; this is what a frame is bound to. Sightings of a point are multiplied before one logarithm is taken of them. Limbs whose sides may be exchanged are in
//! [`exchanged_limbs`](crate::keypoints::exchanged_limbs).

use crate::cameras::camera::MIN_DEPTH_M;
use crate::cameras::lane_projection::{LaneCamera, LaneCameras};
use crate::cameras::lens::Distort;
use crate::keypoints::exchanged_limbs::{Doubts, Exchanging, Nothing};
use crate::keypoints::sighting::{Noise, Sighting};
use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton};
use sinew_core::elementary::ln;
use sinew_core::lanes::Real;
use sinew_core::{compile_curvature_here, compile_density_here};
use std::sync::Arc;

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
    /// Limbs whose sides may be exchanged; their sightings are not among the others.
    pub(crate) doubts: Doubts,
}

/// Factors of the likelihood whose product cannot underflow before its logarithm is taken.
const FACTORS: usize = 16;

impl LaneDensity for KeypointLikelihood {
    compile_density_here!();

    fn dim(&self) -> usize {
        self.plan.dof()
    }

    fn workspace(&self) -> usize {
        self.plan.workspace() + self.doubts.workspace()
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
        self.sightings.is_empty() && self.doubts.is_empty()
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
        if self.doubts.is_empty() {
            self.plan.walk::<V, GRAD>(x, grad, ws, &mut visitor);
            return visitor.value;
        }
        let (ws, own) = ws.split_at_mut(self.plan.workspace());
        let mut scratch = self.doubts.scratch(own);
        let mut pass = self.plan.pass(ws);
        let mut exchanging = Exchanging::<'_, '_, _, L, _, GRAD> {
            doubts: &self.doubts,
            noise: self.noise,
            cameras,
            scratch: &mut scratch,
            others: &mut visitor,
        };
        exchanging.begin::<V>();
        self.plan.forward::<V, GRAD>(x, &mut pass, &mut exchanging);
        let value = visitor.value + self.doubts.settle::<V>(self.noise, &mut scratch);
        if GRAD {
            self.doubts.push::<V>(&scratch, &self.plan, &mut pass);
            self.plan.pullback::<V>(&mut pass, grad);
        }
        value
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
        let noise = self.likelihood.noise;
        for sightings in self.likelihood.sightings_of(k).chunks(FACTORS) {
            let mut product = s(1.0);
            for sighting in sightings {
                let camera = &self.cameras[sighting.camera];
                let shown = camera.show::<V, GRAD>(p);
                let [r0, r1] = camera.residual(&shown, sighting.pixel);
                let (factor, weight) = noise.factor(sighting, [r0, r1], shown.depth);
                product = product * factor;
                if GRAD {
                    let g = camera.pull(&shown, [weight * r0, weight * r1]);
                    force = [force[0] + g[0], force[1] + g[1], force[2] + g[2]];
                }
            }
            self.value = ln(product).fma(s(noise.exponent()), self.value);
        }
        force
    }
}

impl KeypointLikelihood {
    /// Sightings of point k in the plan's order.
    #[inline(always)]
    fn sightings_of(&self, k: usize) -> &[Sighting] {
        &self.sightings[self.first[k]..self.first[k + 1]]
    }
}

/// Information of sightings on their points' positions: each in full, outlier or not, or `WEIGHTED` by the share of its core at the state.
struct Information<'a, M, L, const WEIGHTED: bool> {
    likelihood: &'a KeypointLikelihood,
    cameras: &'a [LaneCamera<L>],
    /// For each doubt the probability that sides are exchanged, before another number; not looked at where nothing is weighted.
    exchanged: &'a [[M; 2]],
}

impl<M, L: Distort, const WEIGHTED: bool> Information<'_, M, L, WEIGHTED> {
    /// Adds that of a sighting, times a share.
    #[inline(always)]
    fn add<V: Real>(&self, m: &mut [V; 6], sighting: &Sighting, p: [V; 3], share: V) {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let camera = &self.cameras[sighting.camera];
        let shown = camera.show::<V, true>(p);
        let mut information = shown.depth.select_gt(MIN_DEPTH_M, V::splat(sighting.information) * share, zero);
        if WEIGHTED {
            information = information
                * self.likelihood.noise.share(sighting, camera.residual(&shown, sighting.pixel), shown.depth);
        }
        for e in [[one, zero], [zero, one]] {
            let g = camera.pull(&shown, e);
            let w = [information * g[0], information * g[1], information * g[2]];
            *m = [
                w[0].fma(g[0], m[0]),
                w[0].fma(g[1], m[1]),
                w[0].fma(g[2], m[2]),
                w[1].fma(g[1], m[3]),
                w[1].fma(g[2], m[4]),
                w[2].fma(g[2], m[5]),
            ];
        }
    }
}

impl<V: Real, L: Distort, const WEIGHTED: bool> Inform<V> for Information<'_, V::Mem, L, WEIGHTED> {
    #[inline(always)]
    fn information(&self, k: usize, p: [V; 3]) -> [V; 6] {
        let mut m = [V::splat(0.0); 6];
        for sighting in self.likelihood.sightings_of(k) {
            self.add(&mut m, sighting, p, V::splat(1.0));
        }
        for member in self.likelihood.doubts.members_of(k) {
            let exchanged = if WEIGHTED {
                V::load(&self.exchanged[member.doubt][0])
            } else {
                V::splat(f64::from(member.straight.is_none()))
            };
            for (sighting, share) in [(&member.straight, V::splat(1.0) - exchanged), (&member.crossed, exchanged)] {
                if let Some(sighting) = sighting {
                    self.add(&mut m, sighting, p, share);
                }
            }
        }
        m
    }
}

impl KeypointLikelihood {
    #[inline(always)]
    fn informed<V: Real, L: Distort, const WEIGHTED: bool>(
        &self,
        cameras: &[LaneCamera<L>],
        x: &[V::Mem],
        matrix: &mut [V::Mem],
        ws: &mut [V::Mem],
    ) {
        let (ws, own) = ws.split_at_mut(self.plan.workspace());
        let mut scratch = self.doubts.scratch(own);
        if WEIGHTED && !self.doubts.is_empty() {
            let mut exchanging = Exchanging::<'_, '_, _, L, _, false> {
                doubts: &self.doubts,
                noise: self.noise,
                cameras,
                scratch: &mut scratch,
                others: &mut Nothing,
            };
            exchanging.begin::<V>();
            self.plan.forward::<V, false>(x, &mut self.plan.pass(ws), &mut exchanging);
            self.doubts.settle::<V>(self.noise, &mut scratch);
        }
        let information = Information::<'_, _, L, WEIGHTED> { likelihood: self, cameras, exchanged: scratch.products };
        self.plan.gauss_newton::<V>(x, ws, matrix, &information);
    }

    #[inline(always)]
    fn matrix<V: Real, const WEIGHTED: bool>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        match &self.cameras {
            LaneCameras::Brown(cameras) => self.informed::<V, _, WEIGHTED>(cameras, x, matrix, ws),
            LaneCameras::Mixed(cameras) => self.informed::<V, _, WEIGHTED>(cameras, x, matrix, ws),
        }
    }
}

impl LaneGaussNewton for KeypointLikelihood {
    compile_curvature_here!();

    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], ws: &mut [V::Mem]) {
        match &self.cameras {
            LaneCameras::Brown(cameras) => {
                let information = Information::<'_, _, _, false> { likelihood: self, cameras, exchanged: &[] };
                self.plan.gauss_newton_diagonal::<V>(x, ws, diagonal, &information);
            }
            LaneCameras::Mixed(cameras) => {
                let information = Information::<'_, _, _, false> { likelihood: self, cameras, exchanged: &[] };
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
        let mut broad = self.clone();
        broad.sightings.iter_mut().for_each(|sighting| self.noise.broaden(sighting, factor));
        let doubted = broad.doubts.broaden(self.noise, factor);
        broad.constant -= 2.0 * factor.ln() * (self.sightings.len() + doubted) as f64;
        Some(broad)
    }
}
