//! Gaussian likelihood of markers in several normalised images: that of [`crate::one_view`] with cameras anywhere.
//!
//! A camera stands at C with the axes right e₀, forward e₁ and up e₂ and has focal length 1. With p_a = e_a · (P − C) a marker at P is seen at `(u, v) = (p₀/p₁, p₂/p₁)`; errors are independent
//! N(0, σ²) in every coordinate of every image, so
//!
//! ```text
//! log p(d | s) = −n log(2π σ²) − 1/(2σ²) Σ r²          n: sightings, r: observed − projected
//! ∂(u, v)/∂P   = 1/p₁ (e₀ − u e₁, e₂ − v e₁)
//! ```
//!
//! The body is moved once for all cameras. A marker that a camera did not see drops out there; a seen marker at depth p₁ ≤ 0.05 m makes the density −∞.

use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton, Lanes};
use sinew_core::lanes::{Isa, Real};
use sinew_observe::{MIN_DEPTH_M, ObservationModel};
use std::sync::Arc;

/// A camera of focal length 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarkerView {
    /// Camera centre in the world, metres.
    pub centre: [f64; 3],
    /// Unit vectors in the world: right, forward, up.
    pub axes: [[f64; 3]; 3],
}

impl MarkerView {
    /// A level camera at a distance from a point, looking at it. At azimuth 0 it looks along +Y; the azimuth turns it about the vertical through the point, counterclockwise from above.
    #[must_use]
    pub fn around(point: [f64; 3], distance_m: f64, azimuth: f64) -> Self {
        let (sin, cos) = azimuth.sin_cos();
        let forward = [-sin, cos, 0.0];
        let centre = [0, 1, 2].map(|k: usize| point[k] - distance_m * forward[k]);
        Self { centre, axes: [[cos, sin, 0.0], forward, [0.0, 0.0, 1.0]] }
    }

    /// Image position of a point; none at depths of 0.05 m and less.
    #[must_use]
    pub fn project(&self, point: [f64; 3]) -> Option<[f64; 2]> {
        let [u, depth, v] = self.axes.map(|axis| (0..3).map(|k| axis[k] * (point[k] - self.centre[k])).sum::<f64>());
        (depth > MIN_DEPTH_M).then_some([u / depth, v / depth])
    }

    /// Depth, its inverse (of the least depth where the point is nearer), image position.
    #[inline(always)]
    fn image<V: Real>(&self, p: [V; 3]) -> Image<V> {
        let from = [0, 1, 2].map(|k: usize| p[k] - V::splat(self.centre[k]));
        let along = |axis: [f64; 3]| {
            from[2].fma(V::splat(axis[2]), from[1].fma(V::splat(axis[1]), from[0] * V::splat(axis[0])))
        };
        let depth = along(self.axes[1]);
        let inverse_depth = V::splat(1.0) / depth.max(V::splat(MIN_DEPTH_M));
        let (u, v) = (along(self.axes[0]) * inverse_depth, along(self.axes[2]) * inverse_depth);
        let slope = |axis: [f64; 3], x: V| [0, 1, 2].map(|k: usize| V::splat(axis[k]) - x * V::splat(self.axes[1][k]));
        Image { depth, inverse_depth, at: [u, v], slopes: [slope(self.axes[0], u), slope(self.axes[2], v)] }
    }
}

/// A point in an image, and the derivatives of its coordinates times the depth.
struct Image<V> {
    depth: V,
    inverse_depth: V,
    at: [V; 2],
    slopes: [[V; 3]; 2],
}

/// Markers on a body, seen by several cameras.
#[derive(Clone, Debug)]
pub struct MarkerViewsModel {
    /// The body; its points are the markers.
    pub plan: Arc<Plan>,
    /// The cameras.
    pub views: Vec<MarkerView>,
    /// Standard deviation of each image coordinate, in units of the focal length.
    pub sigma: f64,
    /// Instruction set for the kernels.
    pub isa: Isa,
}

/// The likelihood of one frame of markers in several images.
#[derive(Clone, Debug)]
pub struct MarkerViewsLikelihood {
    plan: Arc<Plan>,
    views: Vec<MarkerView>,
    information: f64,
    constant: f64,
    /// Image positions of each point in the plan's order, one a view.
    seen: Vec<Vec<Option<[f64; 2]>>>,
}

impl ObservationModel for MarkerViewsModel {
    /// For each view, one image position for each point of the plan; `None` where it was not seen.
    type Frame<'a> = &'a [Vec<Option<[f64; 2]>>];
    type Bound = Lanes<MarkerViewsLikelihood>;

    fn bind(&self, frame: Self::Frame<'_>) -> Self::Bound {
        let in_view = |view: usize, k: usize| frame.get(view).and_then(|seen| seen.get(k).copied().flatten());
        let in_views = |&k: &usize| (0..self.views.len()).map(|view| in_view(view, k)).collect();
        let seen: Vec<Vec<_>> = self.plan.order().iter().map(in_views).collect();
        let variance = self.sigma * self.sigma;
        let sightings = seen.iter().flatten().flatten().count();
        let leaf = MarkerViewsLikelihood {
            plan: Arc::clone(&self.plan),
            views: self.views.clone(),
            information: 1.0 / variance,
            constant: -(sightings as f64) * (std::f64::consts::TAU * variance).ln(),
            seen,
        };
        Lanes { leaf, isa: self.isa }
    }
}

impl LaneDensity for MarkerViewsLikelihood {
    fn dim(&self) -> usize {
        self.plan.dof()
    }

    fn workspace(&self) -> usize {
        self.plan.workspace()
    }

    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let mut residuals = Residuals { likelihood: self, squares: V::splat(0.0), nearest: V::splat(f64::MIN) };
        self.plan.walk::<V, GRAD>(x, grad, ws, &mut residuals);
        let value = residuals.squares.fma(V::splat(-0.5 * self.information), V::splat(self.constant));
        residuals.nearest.select_gt(-MIN_DEPTH_M, V::splat(f64::NEG_INFINITY), value)
    }
}

/// Sum of squares of the residuals, and the largest negative depth.
struct Residuals<'a, V> {
    likelihood: &'a MarkerViewsLikelihood,
    squares: V,
    nearest: V,
}

impl<V: Real> Visit<V> for Residuals<'_, V> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: [V; 3]) -> [V; 3] {
        let mut force = [V::splat(0.0); 3];
        for (view, observed) in self.likelihood.views.iter().zip(&self.likelihood.seen[k]) {
            let Some(observed) = observed else { continue };
            let Image { depth, inverse_depth, at, slopes } = view.image(p);
            self.nearest = self.nearest.max(-depth);
            let scale = V::splat(self.likelihood.information) * inverse_depth;
            for axis in 0..2 {
                let residual = V::splat(observed[axis]) - at[axis];
                self.squares = residual.fma(residual, self.squares);
                let pull = scale * residual;
                for (force, slope) in force.iter_mut().zip(slopes[axis]) {
                    *force = pull.fma(slope, *force);
                }
            }
        }
        force
    }
}

impl<V: Real> Inform<V> for MarkerViewsLikelihood {
    #[inline(always)]
    fn information(&self, k: usize, p: [V; 3]) -> [V; 6] {
        let mut sum = [V::splat(0.0); 6];
        for (view, observed) in self.views.iter().zip(&self.seen[k]) {
            if observed.is_none() {
                continue;
            }
            let Image { inverse_depth, slopes, .. } = view.image(p);
            let w = V::splat(self.information) * inverse_depth * inverse_depth;
            for s in slopes {
                let [x, y, z] = s.map(|s| w * s);
                let products = [x * s[0], x * s[1], x * s[2], y * s[1], y * s[2], z * s[2]];
                for (sum, product) in sum.iter_mut().zip(products) {
                    *sum = *sum + product;
                }
            }
        }
        sum
    }
}

impl LaneGaussNewton for MarkerViewsLikelihood {
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
    use crate::one_view::MarkerModel;
    use sinew_body::standard::cf28;
    use sinew_body::{Proportions, point_positions};
    use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
    use sinew_core::lanes::{Block, triangle};
    use std::f64::consts::FRAC_PI_2;

    const SIGMA: f64 = 0.01;

    fn plan() -> Arc<Plan> {
        Arc::new(Plan::with_all_points(&cf28(&Proportions::default())))
    }

    fn pose(phase: f64) -> Vec<f64> {
        (0..28).map(|j| 0.25 * (1.7 * f64::from(j) + phase).sin() + if j == 2 { 1.0 } else { 0.0 }).collect()
    }

    fn points(plan: &Plan, state: &[f64]) -> Vec<[f64; 3]> {
        let mut out = vec![0.0; 3 * plan.points()];
        point_positions(plan, Isa::baseline(), state, &mut out);
        out.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
    }

    /// What `count` cameras around the body see of a pose, some of it missing.
    fn scene(count: usize, isa: Isa) -> (MarkerViewsModel, Vec<Vec<Option<[f64; 2]>>>) {
        let plan = plan();
        let views: Vec<MarkerView> =
            (0..count).map(|c| MarkerView::around([0.1, 0.2, 1.0], 4.8, FRAC_PI_2 * c as f64)).collect();
        let seen = views.iter().enumerate().map(|(c, view)| {
            let markers = points(&plan, &pose(0.0)).into_iter().enumerate();
            markers.map(|(k, p)| if (k + c) % 7 == 3 { None } else { view.project(p) }).collect()
        });
        let seen = seen.collect();
        (MarkerViewsModel { plan, views, sigma: SIGMA, isa }, seen)
    }

    #[test]
    fn one_camera_along_y_is_the_camera_of_the_paper() {
        let isa = Isa::best();
        let (model, seen) = scene(1, isa);
        let (several, one) = (
            model.bind(&seen),
            MarkerModel { plan: model.plan, centre: model.views[0].centre, sigma: SIGMA, isa }.bind(&seen[0]),
        );
        let state = pose(0.4);
        let (mut a, mut b) = (vec![0.0; 28], vec![0.0; 28]);
        let (x, y) = (several.log_density_grad(&state, &mut a), one.log_density_grad(&state, &mut b));
        assert!((x - y).abs() < 1e-9 * y.abs(), "{x} {y}");
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8 * y.abs()));
    }

    #[test]
    fn gradients_and_curvature_match_differences_of_the_projections() {
        let (model, seen) = scene(4, Isa::best());
        let bound = model.bind(&seen);
        let state = pose(0.3);
        let h = 1e-5;
        let moved = |j: usize, by: f64| {
            let mut state = state.clone();
            state[j] += by;
            state
        };
        // Image coordinates of all sightings.
        let images = |state: &[f64]| -> Vec<f64> {
            let points = points(&model.plan, state);
            let projected = |(view, seen): (&MarkerView, &Vec<Option<[f64; 2]>>)| -> Vec<f64> {
                let both = points.iter().zip(seen).filter(|(_, s)| s.is_some());
                both.flat_map(|(p, _)| view.project(*p).expect("before the camera")).collect()
            };
            model.views.iter().zip(&seen).flat_map(projected).collect()
        };
        let columns: Vec<Vec<f64>> = (0..28)
            .map(|j| {
                let (up, down) = (images(&moved(j, h)), images(&moved(j, -h)));
                up.iter().zip(down).map(|(a, b)| (a - b) / (2.0 * h)).collect()
            })
            .collect();
        let observed: Vec<f64> = seen.iter().flatten().flatten().flatten().copied().collect();
        let residuals: Vec<f64> = observed.iter().zip(images(&state)).map(|(d, i)| d - i).collect();
        let squares: f64 = residuals.iter().map(|r| r * r).sum();
        let expected = -0.5 * squares / (SIGMA * SIGMA)
            - 0.5 * residuals.len() as f64 * (std::f64::consts::TAU * SIGMA * SIGMA).ln();
        let block: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
        let (mut grad, mut matrix) = (vec![Block::ZERO; 28], vec![Block::ZERO; triangle(28, 0)]);
        let mut diagonal = grad.clone();
        let mut ws = vec![Block::ZERO; bound.workspace()];
        let value = bound.log_density_grad_block(&block, &mut grad, &mut ws);
        assert!((value.0[3] - expected).abs() < 1e-10 * expected.abs(), "{} {expected}", value.0[3]);
        assert!((bound.log_density(&state) - expected).abs() < 1e-10 * expected.abs());
        bound.gauss_newton_block(&block, &mut matrix, &mut ws);
        bound.gauss_newton_diagonal_block(&block, &mut diagonal, &mut ws);
        for i in 0..28 {
            let slope: f64 = columns[i].iter().zip(&residuals).map(|(c, r)| c * r).sum::<f64>() / (SIGMA * SIGMA);
            assert!((grad[i].0[5] - slope).abs() < 1e-6 * slope.abs().max(1e3), "{i}: {} {slope}", grad[i].0[5]);
            assert!((diagonal[i].0[2] - matrix[triangle(i, i)].0[2]).abs() < 1e-9 * diagonal[i].0[2].max(1.0));
            for j in 0..=i {
                let product: f64 =
                    columns[i].iter().zip(&columns[j]).map(|(a, b)| a * b).sum::<f64>() / (SIGMA * SIGMA);
                let found = matrix[triangle(i, j)].0[7];
                assert!((found - product).abs() < 1e-5 * product.abs().max(1e2), "{i} {j}: {found} {product}");
            }
        }
    }

    #[test]
    fn a_seen_marker_behind_any_camera_is_impossible() {
        let (model, seen) = scene(2, Isa::best());
        let mut state = pose(0.0);
        assert!(model.bind(&seen).log_density(&state).is_finite());
        // The second camera stands at x = 4.9 and looks along −x.
        state[0] = 6.0;
        assert_eq!(model.bind(&seen).log_density(&state), f64::NEG_INFINITY);
        assert!(model.bind(&seen[..1]).log_density(&state).is_finite());
    }
}
