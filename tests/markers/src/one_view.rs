//! Gaussian likelihood of markers in one normalised image (Choo & Fleet 2001, eqs. 18 and 20).
//!
//! The camera stands at C and looks along +Y with focal length 1. A marker at P = (X, Y, Z) + C is seen at `(x, z) = (X/Y, Z/Y)`, with
//!
//! ```text
//! log p(d | s) = −n log(2π σ²) − 1/(2σ²) Σ_l |d_l − d̂_l(s)|²        r_l = d_l − d̂_l
//! ∂ log p/∂P_l = 1/(σ² Y) (r₁, −(x r₁ + z r₂), r₂)                  Π = 1/Y [[1, −x, 0], [0, −z, 1]]
//! ```
//!
//! A marker that was not seen drops out. Any seen marker at depth Y ≤ 0.05 m makes the density −∞.

use crate::cameras::camera::MIN_DEPTH_M;
use crate::model::ObservationModel;
use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton, Lanes};
use sinew_core::lanes::{Isa, Real};
use sinew_core::{compile_curvature_here, compile_density_here};
use std::sync::Arc;

/// Markers on a body, seen by the paper's camera.
#[derive(Clone, Debug)]
pub struct MarkerModel {
    /// The body; its points are the markers.
    pub plan: Arc<Plan>,
    /// Camera centre in the world, metres.
    pub centre: [f64; 3],
    /// Standard deviation of each image coordinate, in units of the focal length.
    pub sigma: f64,
    /// Instruction set for the kernels.
    pub isa: Isa,
}

/// The likelihood of one frame of markers.
#[derive(Clone, Debug)]
pub struct MarkerLikelihood {
    plan: Arc<Plan>,
    centre: [f64; 3],
    information: f64,
    constant: f64,
    /// Image position of each point in the plan's order.
    seen: Vec<Option<[f64; 2]>>,
}

impl ObservationModel for MarkerModel {
    /// One image position for each point of the plan; `None` where it was not seen.
    type Frame<'a> = &'a [Option<[f64; 2]>];
    type Bound = Lanes<MarkerLikelihood>;

    fn bind(&self, frame: Self::Frame<'_>) -> Self::Bound {
        let seen: Vec<_> = self.plan.order().iter().map(|&k| frame.get(k).copied().flatten()).collect();
        let variance = self.sigma * self.sigma;
        let constant = -(seen.iter().flatten().count() as f64) * (std::f64::consts::TAU * variance).ln();
        let leaf = MarkerLikelihood {
            plan: Arc::clone(&self.plan),
            centre: self.centre,
            information: 1.0 / variance,
            constant,
            seen,
        };
        Lanes { leaf, isa: self.isa }
    }
}

impl LaneDensity for MarkerLikelihood {
    compile_density_here!();

    fn dim(&self) -> usize {
        self.plan.dof()
    }

    fn workspace(&self) -> usize {
        self.plan.workspace()
    }

    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let mut residuals = Residuals { likelihood: self, squares: V::splat(0.0), nearest: V::splat(f64::MIN) };
        self.plan.sweep::<V, GRAD>(x, grad, ws, &mut residuals);
        let value = residuals.squares.fma(V::splat(-0.5 * self.information), V::splat(self.constant));
        residuals.nearest.select_gt(-MIN_DEPTH_M, V::splat(f64::NEG_INFINITY), value)
    }
}

/// Sum of squares of the residuals, and the largest negative depth.
struct Residuals<'a, V> {
    likelihood: &'a MarkerLikelihood,
    squares: V,
    nearest: V,
}

impl<V: Real> Visit<V> for Residuals<'_, V> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: [V; 3]) -> [V; 3] {
        let Some(observed) = self.likelihood.seen[k] else { return [V::splat(0.0); 3] };
        let Image { u, v, inverse_depth, depth } = self.likelihood.image(p);
        self.nearest = self.nearest.max(-depth);
        let (r0, r1) = (V::splat(observed[0]) - u, V::splat(observed[1]) - v);
        self.squares = r1.fma(r1, r0.fma(r0, self.squares));
        let scale = V::splat(self.likelihood.information) * inverse_depth;
        let (g0, g2) = (scale * r0, scale * r1);
        [g0, -v.fma(g2, u * g0), g2]
    }
}

/// A point in the image.
struct Image<V> {
    u: V,
    v: V,
    /// Of the depth, or of the least depth where the point is nearer.
    inverse_depth: V,
    depth: V,
}

impl MarkerLikelihood {
    #[inline(always)]
    fn image<V: Real>(&self, p: [V; 3]) -> Image<V> {
        let depth = p[1] - V::splat(self.centre[1]);
        let inverse_depth = V::splat(1.0) / depth.max(V::splat(MIN_DEPTH_M));
        let u = (p[0] - V::splat(self.centre[0])) * inverse_depth;
        let v = (p[2] - V::splat(self.centre[2])) * inverse_depth;
        Image { u, v, inverse_depth, depth }
    }
}

impl<V: Real> Inform<V> for MarkerLikelihood {
    #[inline(always)]
    fn information(&self, k: usize, p: [V; 3]) -> [V; 6] {
        let Image { u, v, inverse_depth, .. } = self.image(p);
        let w = V::splat(if self.seen[k].is_some() { self.information } else { 0.0 }) * inverse_depth * inverse_depth;
        [w, -(w * u), V::splat(0.0), w * v.fma(v, u * u), -(w * v), w]
    }
}

impl LaneGaussNewton for MarkerLikelihood {
    compile_curvature_here!();

    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.plan.gauss_newton_diagonal::<V>(x, ws, diagonal, self);
    }

    #[inline(always)]
    fn gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.plan.gauss_newton::<V>(x, ws, matrix, self);
    }
}
