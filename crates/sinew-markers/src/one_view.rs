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

use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton, Lanes};
use sinew_core::lanes::{Isa, Real};
use sinew_core::{compile_curvature_here, compile_density_here};
use sinew_observe::{MIN_DEPTH_M, ObservationModel};
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sinew_body::standard::cf28;
    use sinew_body::{Proportions, point_positions};
    use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
    use sinew_core::lanes::{Block, LANES, set_lane};

    fn markers(isa: Isa) -> impl GaussNewton {
        let plan = Arc::new(Plan::with_all_points(&cf28(&Proportions::default())));
        let model = MarkerModel { plan, centre: [0.1, -4.8, 1.0], sigma: 0.003, isa };
        let frame: Vec<_> =
            (0..17).map(|k| (k != 3).then(|| [0.003 * f64::from(k) - 0.02, 0.01 * f64::from(k) - 0.1])).collect();
        model.bind(&frame)
    }

    fn pose() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-0.3..0.3, 28).prop_map(|mut q| {
            q[2] += 1.0;
            q
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn marker_gradient_agrees_with_central_differences(q in pose()) {
            let density = markers(Isa::best());
            let mut grad = vec![0.0; 28];
            density.log_density_grad(&q, &mut grad);
            let largest = grad.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
            for j in 0..28 {
                let at = |h: f64| {
                    let mut q = q.clone();
                    q[j] += h;
                    density.log_density(&q)
                };
                let h = 1e-4;
                let numeric = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                prop_assert!((numeric - grad[j]).abs() < 1e-6 * largest, "coordinate {j}: {numeric} against {}", grad[j]);
            }
        }

        /// To 1e-12 · max(1, |log p|).
        #[test]
        fn block_and_single_state_agree_on_every_instruction_set(q in pose()) {
            let states: Vec<Vec<f64>> = (0..LANES).map(|l| q.iter().map(|q| q + 0.01 * l as f64).collect()).collect();
            let mut block = vec![Block::ZERO; 28];
            states.iter().enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
            let reference = markers(Isa::baseline());
            for isa in Isa::available() {
                let density = markers(isa);
                let (mut ws, mut grad) = (vec![Block::ZERO; density.workspace()], vec![Block::ZERO; 28]);
                let value = density.log_density_grad_block(&block, &mut grad, &mut ws);
                let plain = density.log_density_block(&block, &mut ws);
                for (lane, state) in states.iter().enumerate() {
                    let mut expected_grad = vec![0.0; 28];
                    let expected = reference.log_density_grad(state, &mut expected_grad);
                    for found in [value.0[lane], plain.0[lane], density.log_density(state)] {
                        let near = (found - expected).abs() <= 1e-12 * expected.abs().max(1.0);
                        prop_assert!(near, "{}: {found} against {expected}", isa.name());
                    }
                    let largest = expected_grad.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
                    let near = grad.iter().zip(&expected_grad).all(|(g, e)| (g.0[lane] - e).abs() <= 1e-11 * largest);
                    prop_assert!(near, "{}", isa.name());
                }
            }
        }

        /// Curvature (K5): the diagonal is the squared column norm of the numerical Jacobian of the projected markers.
        #[test]
        fn marker_curvature_agrees_with_the_numerical_jacobian(q in pose()) {
            let tree = cf28(&Proportions::default());
            let plan = Plan::with_all_points(&tree);
            let images = |q: &[f64]| -> Vec<f64> {
                let mut p = vec![0.0; 3 * plan.points()];
                point_positions(&plan, Isa::best(), q, &mut p);
                (0..17)
                    .filter(|&k| k != 3)
                    .flat_map(|k| {
                        let y = p[3 * k + 1] + 4.8;
                        [(p[3 * k] - 0.1) / y, (p[3 * k + 2] - 1.0) / y]
                    })
                    .collect()
            };
            let density = markers(Isa::best());
            let block: Vec<Block> = q.iter().map(|&x| Block::splat(x)).collect();
            let mut diagonal = vec![Block::ZERO; 28];
            density.gauss_newton_diagonal_block(&block, &mut diagonal, &mut vec![Block::ZERO; density.workspace()]);
            let all: Vec<f64> = (0..28)
                .map(|j| {
                    let at = |h: f64| {
                        let mut q = q.clone();
                        q[j] += h;
                        images(&q)
                    };
                    at(1e-6).iter().zip(at(-1e-6)).map(|(a, b)| ((a - b) / 2e-6).powi(2)).sum::<f64>() / (0.003 * 0.003)
                })
                .collect();
            let largest = all.iter().fold(0.0_f64, |m, &x| m.max(x));
            for (found, expected) in diagonal.iter().zip(all) {
                prop_assert!((found.0[1] - expected).abs() < 1e-7 * largest, "{} against {expected}", found.0[1]);
            }
        }
    }

    #[test]
    fn a_marker_behind_the_camera_makes_the_density_vanish() {
        let mut q = vec![0.0; 28];
        q[1] = -6.0;
        assert_eq!(markers(Isa::best()).log_density(&q), f64::NEG_INFINITY);
    }
}
