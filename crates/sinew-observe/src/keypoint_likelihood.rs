//! Robust likelihood of detected keypoints in any number of calibrated cameras.
//!
//! A *sighting* is one keypoint in one camera. With the residual r (pixels) between the detection, freed of its camera's constant offset, and the distorted
//! projection of the body's point, and s the sighting's standard deviation per axis, its density is one of [`Noise`]:
//!
//! ```text
//! outlier floor    p = (1 − ε) / (2π s²) · exp(−r²/2s²) + ε / A             A: area of the image
//! Student t        p = 1 / (2π s²) · (1 + r²/(ν s²))^(−(ν + 2)/2)           in two dimensions
//! ```
//!
//! s² has three sources: the camera's pixel noise σ², larger for keypoints of lower confidence than usual, `σ² c₀/c`; and the model error τ (metres), since a
//! keypoint is not a joint of the body: at depth z it is `τ f/z` pixels. A point's model error is one displacement in space, the same for all n cameras that see
//! it, and not n independent ones; n sightings with the variance `⅔ n τ²` together know the point's position to τ in each direction, so that is what each gets. Depths for this are taken at the
//! predicted pose when the frame is bound: s does not depend on the state.
//!
//! A missing keypoint drops out. A point behind a camera counts as an outlier there: its floor (for Student t the density at 1000 s), gradient 0, so that one wrong
//! camera cannot veto every pose.

use crate::camera::{Camera, MIN_DEPTH_M};
use crate::model::ObservationModel;
use sinew_body::Plan;
use sinew_body::kinematics::{Inform, Visit};
use sinew_core::density::{LaneDensity, LaneGaussNewton, Lanes};
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::{Isa, Real};
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

/// One detected keypoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Image position, pixels.
    pub pixel: [f64; 2],
    /// The detector's confidence, 0 to 1.
    pub confidence: f64,
}

/// A camera with what the set-up pass found out about its detections.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Constant offset of its detections (observed − projected), pixels.
    pub offset_px: [f64; 2],
    /// Standard deviation per axis of a detection of usual confidence, pixels.
    pub sigma_px: f64,
    /// Usual confidence c₀.
    pub usual_confidence: f64,
}

/// The keypoints of a body in a set of cameras.
#[derive(Clone, Debug)]
pub struct KeypointModel {
    /// The body; its points are the keypoints.
    pub plan: Arc<Plan>,
    /// The cameras.
    pub views: Vec<View>,
    /// Shape of the density.
    pub noise: Noise,
    /// Distance between a keypoint and the body's point, per axis, metres.
    pub model_error_m: f64,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Instruction set for the kernels.
    pub isa: Isa,
}

/// What was detected in one frame, and where the points are expected.
#[derive(Clone, Copy, Debug)]
pub struct KeypointFrame<'a> {
    /// For each view, for each point of the plan, its detection if any.
    pub detections: &'a [Vec<Option<Detection>>],
    /// Predicted world positions of the points, three numbers each, metres.
    pub predicted: &'a [f64],
}

#[derive(Clone, Debug)]
struct Lens {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    focal: [f64; 2],
    radial: [f64; 3],
    tangential: [f64; 2],
    distorted: bool,
}

#[derive(Clone, Debug)]
struct Sighting {
    lens: usize,
    /// Detection minus offset minus principal point, pixels.
    pixel: [f64; 2],
    /// 1/s².
    information: f64,
    /// Outlier floor relative to the core's peak; with Student t, 1/(ν s²).
    shape: f64,
}

/// The likelihood of one frame of keypoints.
#[derive(Clone, Debug)]
pub struct KeypointLikelihood {
    plan: Arc<Plan>,
    lenses: Vec<Lens>,
    sightings: Vec<Sighting>,
    /// Sightings of point k in the plan's order: `sightings[first[k]..first[k + 1]]`.
    first: Vec<usize>,
    noise: Noise,
    constant: f64,
}

/// Depth of a point in a camera, metres.
fn depth(camera: &Camera, p: &[f64]) -> f64 {
    let row = camera.rotation[2];
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + camera.translation[2]
}

impl KeypointModel {
    /// Variance s² per axis, square pixels, of a detection in a view: of a point that is expected at `point_in_world` and seen by so many cameras.
    #[must_use]
    pub fn variance_px2(&self, view: usize, confidence: f64, cameras: usize, point_in_world: &[f64]) -> f64 {
        let View { camera, sigma_px, usual_confidence, .. } = &self.views[view];
        let shared = 2.0 / 3.0 * cameras as f64 * self.model_error_m.powi(2);
        let scale = camera.intrinsics.fx / depth(camera, point_in_world).max(MIN_DEPTH_M);
        sigma_px.powi(2) * usual_confidence / confidence.max(0.01) + shared * scale * scale
    }
}

impl ObservationModel for KeypointModel {
    type Frame<'a> = KeypointFrame<'a>;
    type Bound = Lanes<KeypointLikelihood>;

    fn bind(&self, frame: KeypointFrame<'_>) -> Self::Bound {
        let lenses = self
            .views
            .iter()
            .map(|view| {
                let (i, d) = (&view.camera.intrinsics, &view.camera.distortion);
                Lens {
                    rotation: view.camera.rotation,
                    translation: view.camera.translation,
                    focal: [i.fx, i.fy],
                    radial: [d.k1, d.k2, d.k3],
                    tangential: [d.p1, d.p2],
                    distorted: *d != crate::camera::Distortion::default(),
                }
            })
            .collect();
        let mut sightings = vec![];
        let mut first = vec![0];
        let mut constant = 0.0;
        for &k in self.plan.order() {
            let seen: Vec<(usize, Detection)> = frame
                .detections
                .iter()
                .enumerate()
                .filter_map(|(c, points)| points.get(k).copied().flatten().map(|d| (c, d)))
                .filter(|(_, d)| d.confidence >= self.least_confidence && d.pixel.iter().all(|x| x.is_finite()))
                .collect();
            let cameras = seen.len();
            for (c, detection) in seen {
                let view = &self.views[c];
                let camera = &view.camera;
                let variance = self.variance_px2(c, detection.confidence, cameras, &frame.predicted[3 * k..3 * k + 3]);
                let peak = 1.0 / (std::f64::consts::TAU * variance);
                let shape = match self.noise {
                    Noise::OutlierFloor { outlier } => {
                        constant += ((1.0 - outlier) * peak).ln();
                        let area = camera.image_size_px[0] * camera.image_size_px[1];
                        outlier / (area * (1.0 - outlier) * peak)
                    }
                    Noise::StudentT { degrees } => {
                        constant += peak.ln();
                        1.0 / (degrees * variance)
                    }
                };
                let i = &camera.intrinsics;
                sightings.push(Sighting {
                    lens: c,
                    pixel: [
                        detection.pixel[0] - view.offset_px[0] - i.cx,
                        detection.pixel[1] - view.offset_px[1] - i.cy,
                    ],
                    information: 1.0 / variance,
                    shape,
                });
            }
            first.push(sightings.len());
        }
        let leaf =
            KeypointLikelihood { plan: Arc::clone(&self.plan), lenses, sightings, first, noise: self.noise, constant };
        Lanes { leaf, isa: self.isa }
    }
}

/// A point in a lens: residual (pixels) and its derivative with respect to the camera coordinates.
struct Seen<V> {
    residual: [V; 2],
    inverse_depth: V,
    normalised: [V; 2],
    /// Derivative of the distorted with respect to the undistorted coordinates (xx, xy, yx, yy), times the focal lengths.
    slope: [V; 4],
    depth: V,
}

#[inline(always)]
fn look<V: Real, const SLOPE: bool>(lens: &Lens, p: [V; 3], pixel: [f64; 2]) -> Seen<V> {
    let s = |x: f64| V::splat(x);
    let row = |i: usize| {
        let r = &lens.rotation[i];
        p[2].fma(s(r[2]), p[1].fma(s(r[1]), p[0].fma(s(r[0]), s(lens.translation[i]))))
    };
    let depth = row(2);
    let inverse_depth = s(1.0) / depth.max(s(MIN_DEPTH_M));
    let (x, y) = (row(0) * inverse_depth, row(1) * inverse_depth);
    let (fx, fy) = (s(lens.focal[0]), s(lens.focal[1]));
    let (mut xd, mut yd) = (x, y);
    let mut slope = [fx, s(0.0), s(0.0), fy];
    if lens.distorted {
        let [k1, k2, k3] = lens.radial.map(s);
        let [p1, p2] = lens.tangential.map(s);
        let r2 = y.fma(y, x * x);
        let radial = r2.fma(r2.fma(r2.fma(k3, k2), k1), s(1.0));
        let two = s(2.0);
        let t = y.fma(p1, x * p2) * two;
        // x (radial + 2 p1 y + 2 p2 x) + p2 r², y (radial + 2 p1 y + 2 p2 x) + p1 r²
        xd = x.fma(radial + t, p2 * r2);
        yd = y.fma(radial + t, p1 * r2);
        if SLOPE {
            let growth = r2.fma(r2.fma(s(3.0) * k3, two * k2), k1) * two;
            let cross = (x * y).fma(growth, y.fma(p2, x * p1) * two);
            let xx = (x * x).fma(growth, radial + t) + x * p2 * s(4.0);
            let yy = (y * y).fma(growth, radial + t) + y * p1 * s(4.0);
            slope = [xx * fx, cross * fx, cross * fy, yy * fy];
        }
    }
    Seen {
        residual: [xd.fnma(fx, s(pixel[0])), yd.fnma(fy, s(pixel[1]))],
        inverse_depth,
        normalised: [x, y],
        slope,
        depth,
    }
}

/// World-frame product of the 2-vector `e` with the Jacobian of the projection: `Jᵀ e`.
#[inline(always)]
fn pull<V: Real>(lens: &Lens, seen: &Seen<V>, e: [V; 2]) -> [V; 3] {
    let s = |x: f64| V::splat(x);
    let [xx, xy, yx, yy] = seen.slope;
    let gx = e[1].fma(yx, e[0] * xx) * seen.inverse_depth;
    let gy = e[1].fma(yy, e[0] * xy) * seen.inverse_depth;
    let gz = -seen.normalised[1].fma(gy, seen.normalised[0] * gx);
    let column = |i: usize| {
        let r = &lens.rotation;
        gz.fma(s(r[2][i]), gy.fma(s(r[1][i]), gx * s(r[0][i])))
    };
    [column(0), column(1), column(2)]
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
        let mut visitor = LogDensities::<'_, V, GRAD> { of: self, value: V::splat(self.constant) };
        self.plan.walk::<V, GRAD>(x, grad, ws, &mut visitor);
        visitor.value
    }
}

/// Sum of the log densities of the sightings.
struct LogDensities<'a, V, const GRAD: bool> {
    of: &'a KeypointLikelihood,
    value: V,
}

impl<V: Real, const GRAD: bool> Visit<V> for LogDensities<'_, V, GRAD> {
    #[inline(always)]
    fn point(&mut self, k: usize, p: [V; 3]) -> [V; 3] {
        let s = |x: f64| V::splat(x);
        let mut force = [s(0.0); 3];
        for sightings in self.of.sightings_of(k).chunks(FACTORS) {
            let mut product = s(1.0);
            for sighting in sightings {
                let lens = &self.of.lenses[sighting.lens];
                let seen = look::<V, GRAD>(lens, p, sighting.pixel);
                let [r0, r1] = seen.residual;
                let square = r1.fma(r1, r0 * r0);
                let weight;
                match self.of.noise {
                    Noise::OutlierFloor { .. } => {
                        let core = exp(square * s(-0.5 * sighting.information));
                        let core = seen.depth.select_gt(MIN_DEPTH_M, core, s(0.0));
                        let total = core + s(sighting.shape);
                        product = product * total;
                        weight = core / total * s(sighting.information);
                    }
                    Noise::StudentT { degrees } => {
                        let spread = square.fma(s(sighting.shape), s(1.0));
                        let spread = seen.depth.select_gt(MIN_DEPTH_M, spread, s(1e6 / degrees));
                        product = product * spread;
                        let strength = s((degrees + 2.0) * sighting.shape) / spread;
                        weight = seen.depth.select_gt(MIN_DEPTH_M, strength, s(0.0));
                    }
                }
                if GRAD {
                    let g = pull(lens, &seen, [weight * r0, weight * r1]);
                    force = [force[0] + g[0], force[1] + g[1], force[2] + g[2]];
                }
            }
            let exponent = match self.of.noise {
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
    fn share<V: Real>(&self, sighting: &Sighting, seen: &Seen<V>) -> V {
        let [r0, r1] = seen.residual;
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
        seen.depth.select_gt(MIN_DEPTH_M, share, V::splat(0.0))
    }

    /// Sightings of point k in the plan's order.
    #[inline(always)]
    fn sightings_of(&self, k: usize) -> &[Sighting] {
        &self.sightings[self.first[k]..self.first[k + 1]]
    }
}

/// What sightings tell of their points' positions: each in full, outlier or not, or `WEIGHTED` by the share of its core at the state.
struct Information<'a, const WEIGHTED: bool>(&'a KeypointLikelihood);

impl<V: Real, const WEIGHTED: bool> Inform<V> for Information<'_, WEIGHTED> {
    #[inline(always)]
    fn information(&self, k: usize, p: [V; 3]) -> [V; 6] {
        let (zero, one) = (V::splat(0.0), V::splat(1.0));
        let mut m = [zero; 6];
        for sighting in self.0.sightings_of(k) {
            let lens = &self.0.lenses[sighting.lens];
            let seen = look::<V, true>(lens, p, sighting.pixel);
            let mut information = seen.depth.select_gt(MIN_DEPTH_M, V::splat(sighting.information), zero);
            if WEIGHTED {
                information = information * self.0.share(sighting, &seen);
            }
            for e in [[one, zero], [zero, one]] {
                let g = pull(lens, &seen, e);
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

impl LaneGaussNewton for KeypointLikelihood {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, x: &[V::Mem], diagonal: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.plan.gauss_newton_diagonal::<V>(x, ws, diagonal, &Information::<false>(self));
    }

    #[inline(always)]
    fn gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.plan.gauss_newton::<V>(x, ws, matrix, &Information::<false>(self));
    }

    #[inline(always)]
    fn weighted_gauss_newton<V: Real>(&self, x: &[V::Mem], matrix: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.plan.gauss_newton::<V>(x, ws, matrix, &Information::<true>(self));
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
