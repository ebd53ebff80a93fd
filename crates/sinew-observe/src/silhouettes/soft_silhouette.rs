//! A silhouette likelihood with a gradient: the body's limbs lie inside of what each camera saw, by their thickness.
//!
//! On the axis of each solid are [`POINTS`] points. Let s be the signed distance of a pixel from the contour of the silhouette, positive outside, and m = f r / z the radius of the solid in the image at a point's depth z. A limb that is
//! in the silhouette has s + m ≤ 0, and what it sticks out is
//!
//! ```text
//! e = max(0, s + m),      log p = − w Σ (ν + 1)/2 · ln(1 + e²/(ν σ²)),      ν = 4
//! ```
//!
//! a density with heavy tails, since segmentation errs in whole blobs. The weight w = 1/[`POINTS`] makes a solid in one view worth one observation: its points see the same error. It says nothing of pixels that no limb covers, so it
//! belongs beside keypoints, not in their place.
//!
//! s is interpolated between pixel centres, and constant beyond the border of the image. Behind a camera e is [`LOST_PX`], without a gradient.

use crate::cameras::camera::{Camera, MIN_DEPTH_M};
use crate::silhouettes::bit_image::BitImage;
use crate::silhouettes::distance_map::distance_map;
use crate::{Map, ObservationModel};
use sinew_body::flesh::Flesh;
use sinew_body::kinematics::{Inform, V3, Visit};
use sinew_body::{Error, KinematicTree, Plan, Point, point_positions_block};
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, LaneMap, Real, map_block};
use std::sync::Arc;

/// Points on the axis of a solid.
pub const POINTS: usize = 3;
/// What a point behind a camera sticks out, pixels.
pub const LOST_PX: f64 = 1000.0;
const DEGREES: f64 = 4.0;

/// A body before cameras that see silhouettes, for methods with gradients.
#[derive(Clone, Debug)]
pub struct SoftSilhouetteModel {
    plan: Arc<Plan>,
    /// Radius of the solid at each point, metres.
    radii: Arc<Vec<f64>>,
    cameras: Vec<Camera>,
    sigma_px: f64,
    isa: Isa,
}

impl SoftSilhouetteModel {
    /// The solids of a tree before cameras with a perfect lens, sized like the images; `sigma_px` is the error of a contour.
    ///
    /// # Errors
    /// Names of points that the tree has.
    pub fn new(
        tree: &KinematicTree,
        flesh: &Flesh,
        cameras: Vec<Camera>,
        sigma_px: f64,
        isa: Isa,
    ) -> Result<Self, Error> {
        let mut points = tree.points().to_vec();
        let (first, mut radii) = (points.len(), vec![]);
        for solid in flesh.solids() {
            for k in 0..POINTS {
                let z = (k as f64 + 0.5) / POINTS as f64 * solid.frustum.height;
                let offset = [0, 1, 2].map(|axis| solid.base[axis] + z * solid.axes[2][axis]);
                points.push(Point { name: format!("{}/axis {k}", solid.name), link: solid.link, offset });
                radii.push(solid.frustum.radius(z) * solid.frustum.ratio.min(1.0));
            }
        }
        let all: Vec<usize> = (first..points.len()).collect();
        let plan = Plan::new(&KinematicTree::new(tree.links().to_vec(), points)?, &all);
        Ok(Self { plan: Arc::new(plan), radii: Arc::new(radii), cameras, sigma_px, isa })
    }

    /// Degrees of freedom.
    #[must_use]
    pub fn dof(&self) -> usize {
        self.plan.dof()
    }
}

impl ObservationModel for SoftSilhouetteModel {
    type Frame<'a> = &'a [Option<BitImage>];
    type Bound = SoftSilhouette;

    /// Cameras without a silhouette, or with one in which nobody is, say nothing.
    fn bind(&self, frame: &[Option<BitImage>]) -> SoftSilhouette {
        let views = self.cameras.iter().zip(frame).filter_map(|(camera, silhouette)| {
            let silhouette = silhouette.as_ref().filter(|silhouette| silhouette.count() > 0)?;
            Some((camera.clone(), signed_distance(silhouette)))
        });
        SoftSilhouette { views: views.collect(), model: self.clone() }
    }
}

/// Distance of each pixel's centre from the contour, pixels, negative inside.
fn signed_distance(silhouette: &BitImage) -> Map {
    let (width, height) = (silhouette.width(), silhouette.height());
    let background = BitImage::from_fn(width, height, |x, y| !silhouette.get(x, y));
    let mut out = distance_map(silhouette);
    let inside = distance_map(&background);
    // Centres of neighbours on both sides of the contour are half a pixel from it.
    for (s, inside) in out.values.iter_mut().zip(inside.values) {
        *s = if *s > 0.0 { *s - 0.5 } else { 0.5 - inside.min((width + height) as f32) };
    }
    out
}

/// Log density of the body's state given the silhouettes of one frame.
#[derive(Clone, Debug)]
pub struct SoftSilhouette {
    model: SoftSilhouetteModel,
    views: Vec<(Camera, Map)>,
}

/// Value of a map between its pixels, and its slope; `None` for an empty one.
fn interpolated(map: &Map, [x, y]: [f64; 2]) -> Option<(f64, [f64; 2])> {
    let (most_x, most_y) = (map.width.checked_sub(1)?, map.height.checked_sub(1)?);
    let cell = |at: f64, most: usize| {
        let inside = (at - 0.5).clamp(0.0, most as f64);
        let low = (inside as usize).min(most.saturating_sub(1));
        let is_beyond = at - 0.5 != inside || most == 0;
        (low, (low + 1).min(most), inside - low as f64, if is_beyond { 0.0 } else { 1.0 })
    };
    let ((x0, x1, fx, sx), (y0, y1, fy, sy)) = (cell(x, most_x), cell(y, most_y));
    let at = |x: usize, y: usize| map.values.get(y * map.width + x).map(|value| f64::from(*value));
    let [a, b, c, d] = [at(x0, y0)?, at(x1, y0)?, at(x0, y1)?, at(x1, y1)?];
    let (above, below) = (a + fx * (b - a), c + fx * (d - c));
    let along = (b - a) + fy * ((d - c) - (b - a));
    Some((above + fy * (below - above), [sx * along, sy * (below - above)]))
}

/// What all views say of one point of one body.
#[derive(Clone, Copy, Default)]
struct Evidence {
    energy: f64,
    /// ∂ energy / ∂ position, 1/m.
    force: [f64; 3],
    /// xx, xy, xz, yy, yz, zz, 1/m².
    information: [f64; 6],
}

impl SoftSilhouette {
    fn evidence(&self, point: [f64; 3], radius: f64) -> Evidence {
        let (mut found, weight) = (Evidence::default(), 1.0 / POINTS as f64);
        let variance = self.model.sigma_px * self.model.sigma_px;
        let energy = |e: f64| 0.5 * (DEGREES + 1.0) * weight * (e * e / (DEGREES * variance)).ln_1p();
        for (camera, distance) in &self.views {
            let depth = camera.point_in_camera(point)[2];
            let seen = camera.project_with_jacobian(point).filter(|_| depth > MIN_DEPTH_M);
            let Some((pixel, [du, dv])) = seen else {
                found.energy += energy(LOST_PX);
                continue;
            };
            let Some((s, [sx, sy])) = interpolated(distance, pixel) else { continue };
            let margin = camera.intrinsics.fx * radius / depth;
            let e = s + margin;
            if e <= 0.0 {
                continue;
            }
            found.energy += energy(e);
            let jacobian = [0, 1, 2].map(|k| sx * du[k] + sy * dv[k] - margin / depth * camera.rotation[2][k]);
            let w = weight * (DEGREES + 1.0) / (DEGREES * variance + e * e);
            for (force, j) in found.force.iter_mut().zip(jacobian) {
                *force += w * e * j;
            }
            let [x, y, z] = jacobian;
            for (information, product) in found.information.iter_mut().zip([x * x, x * y, x * z, y * y, y * z, z * z]) {
                *information += w * product;
            }
        }
        found
    }

    fn points(&self) -> usize {
        self.model.radii.len()
    }

    /// The evidence on all points of a block of bodies: energies by body, forces and informations by point, in the order in which points were given.
    fn evidence_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let (plan, n) = (&self.model.plan, self.points());
        let (positions, rest) = ws.split_at_mut(3 * n);
        let (forces, rest) = rest.split_at_mut(3 * n);
        let (informations, plan_ws) = rest.split_at_mut(6 * n);
        point_positions_block(plan, self.model.isa, x, positions, plan_ws);
        let mut energy = Block::ZERO;
        for k in 0..n {
            for lane in 0..LANES {
                let at = [0, 1, 2].map(|axis: usize| positions[3 * k + axis].0[lane]);
                let found = self.evidence(at, self.model.radii[k]);
                energy.0[lane] += found.energy;
                forces[3 * k..].iter_mut().zip(found.force).for_each(|(out, f)| out.0[lane] = f);
                informations[6 * k..].iter_mut().zip(found.information).for_each(|(out, i)| out.0[lane] = i);
            }
        }
        energy
    }
}

/// Numbers that were written down for each point.
struct Given<'a, M, const N: usize> {
    order: &'a [usize],
    numbers: &'a [[M; N]],
}

impl<V: Real> Visit<V> for Given<'_, V::Mem, 3> {
    #[inline(always)]
    fn point(&mut self, k: usize, _: V3<V>) -> V3<V> {
        let [x, y, z] = &self.numbers[self.order[k]];
        [V::load(x), V::load(y), V::load(z)]
    }
}

impl<V: Real> Inform<V> for Given<'_, V::Mem, 6> {
    #[inline(always)]
    fn information(&self, k: usize, _: V3<V>) -> [V; 6] {
        let [xx, xy, xz, yy, yz, zz] = &self.numbers[self.order[k]];
        [V::load(xx), V::load(xy), V::load(xz), V::load(yy), V::load(yz), V::load(zz)]
    }
}

struct Pull<'a>(&'a Plan);

impl LaneMap<2, 1> for Pull<'_> {
    #[inline(always)]
    fn run<V: Real>(&self, [x, forces]: [&[V::Mem]; 2], [grad]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        let mut given = Given { order: self.0.order(), numbers: forces.as_chunks::<3>().0 };
        self.0.walk::<V, true>(x, grad, ws, &mut given);
        for g in grad {
            (-V::load(g)).store(g);
        }
    }
}

struct Curve<'a, const DIAGONAL: bool>(&'a Plan);

impl<const DIAGONAL: bool> LaneMap<2, 1> for Curve<'_, DIAGONAL> {
    #[inline(always)]
    fn run<V: Real>(&self, [x, informations]: [&[V::Mem]; 2], [out]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        let given = Given { order: self.0.order(), numbers: informations.as_chunks::<6>().0 };
        if DIAGONAL {
            self.0.gauss_newton_diagonal::<V>(x, ws, out, &given);
        } else {
            self.0.gauss_newton::<V>(x, ws, out, &given);
        }
    }
}

impl LogDensity for SoftSilhouette {
    fn dim(&self) -> usize {
        self.model.dof()
    }

    fn workspace(&self) -> usize {
        12 * self.points() + self.model.plan.workspace()
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        self.log_density_block(&block, &mut vec![Block::ZERO; self.workspace()]).0[0]
    }

    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let energy = self.evidence_block(x, ws);
        Block(energy.0.map(|energy| -energy))
    }
}

impl GradLogDensity for SoftSilhouette {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        let mut grads = vec![Block::ZERO; x.len()];
        let value = self.log_density_grad_block(&block, &mut grads, &mut vec![Block::ZERO; self.workspace()]);
        grad.iter_mut().zip(grads).for_each(|(out, g)| *out = g.0[0]);
        value.0[0]
    }

    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let energy = self.evidence_block(x, ws);
        let n = self.points();
        let (forces, rest) = ws[3 * n..].split_at_mut(3 * n);
        map_block(self.model.isa, &Pull(&self.model.plan), [x, forces], [grad], &mut rest[6 * n..]);
        Block(energy.0.map(|energy| -energy))
    }
}

impl GaussNewton for SoftSilhouette {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.evidence_block(x, ws);
        let n = self.points();
        let (informations, rest) = ws[6 * n..].split_at_mut(6 * n);
        map_block(self.model.isa, &Curve::<true>(&self.model.plan), [x, informations], [diagonal], rest);
    }

    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.evidence_block(x, ws);
        let n = self.points();
        let (informations, rest) = ws[6 * n..].split_at_mut(6 * n);
        map_block(self.model.isa, &Curve::<false>(&self.model.plan), [x, informations], [matrix], rest);
    }
}
