//! Projection of points into a camera over lanes, with its derivative.
//!
//! What [`Camera::project_with_jacobian`] computes for one point, for a block of states at once, through the same code of the lens. With `X = R P + t` and `J_l` the derivative of the lens, a 2-vector e in pixels pulls on the
//! point by
//!
//! ```text
//! (a, b) = J_lᵀ diag(fx, fy) e / Z        Jᵀ e = Rᵀ (a, b, −(x a + y b))
//! ```

use crate::cameras::camera::{Camera, MIN_DEPTH_M};
use crate::cameras::lens::{Brown, Distort, Distortion};
use sinew_core::lanes::Real;

/// What of a camera a projection needs; pixels count from the principal point.
#[derive(Clone, Debug)]
pub(crate) struct LaneCamera<L> {
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    focal: [f64; 2],
    distortion: L,
    /// Square of the radius up to which the lens is one-to-one.
    valid_square: f64,
    is_perfect: bool,
}

/// A point as a camera shows it.
pub(crate) struct Shown<V> {
    /// Depth, metres; 0 for points beyond the domain of the lens. Points at [`MIN_DEPTH_M`] and nearer are not seen, and their other numbers have no meaning.
    pub depth: V,
    /// Where the lens shows it, normalised.
    pub at: [V; 2],
    /// Derivative of pixels by the coordinates before the lens, rows u and v.
    slope: [[V; 2]; 2],
    inverse_depth: V,
    /// Coordinates before the lens.
    ideal: [V; 2],
}

/// Cameras by what lenses they have: the loops over points are compiled for each kind, so that no lens is asked in them what it is where all are the usual ones.
#[derive(Clone, Debug)]
pub(crate) enum LaneCameras {
    /// All lenses are Brown–Conrady or perfect.
    Brown(Vec<LaneCamera<Brown>>),
    /// Any lenses.
    Mixed(Vec<LaneCamera<Distortion>>),
}

impl LaneCameras {
    pub fn new<'a>(cameras: impl Iterator<Item = &'a Camera> + Clone) -> Self {
        let brown = |camera: &Camera| match camera.lens.distortion() {
            Distortion::Brown(brown) => Some(LaneCamera::new(camera, *brown)),
            _ => None,
        };
        match cameras.clone().map(brown).collect() {
            Some(all) => Self::Brown(all),
            None => Self::Mixed(cameras.map(|camera| LaneCamera::new(camera, *camera.lens.distortion())).collect()),
        }
    }
}

impl<L: Distort> LaneCamera<L> {
    fn new(camera: &Camera, distortion: L) -> Self {
        let (i, lens) = (&camera.intrinsics, &camera.lens);
        Self {
            rotation: camera.rotation,
            translation: camera.translation,
            focal: [i.fx, i.fy],
            distortion,
            valid_square: lens.valid_radius() * lens.valid_radius(),
            is_perfect: lens.is_perfect(),
        }
    }

    /// A point of the world; [`LaneCamera::pull`] needs `SLOPE`.
    #[inline(always)]
    pub fn show<V: Real, const SLOPE: bool>(&self, p: [V; 3]) -> Shown<V> {
        let s = |x: f64| V::splat(x);
        let row = |i: usize| {
            let r = &self.rotation[i];
            p[2].fma(s(r[2]), p[1].fma(s(r[1]), p[0].fma(s(r[0]), s(self.translation[i]))))
        };
        let mut depth = row(2);
        let inverse_depth = s(1.0) / depth.max(s(MIN_DEPTH_M));
        let (x, y) = (row(0) * inverse_depth, row(1) * inverse_depth);
        let (fx, fy) = (s(self.focal[0]), s(self.focal[1]));
        let mut at = [x, y];
        let mut slope = [[fx, s(0.0)], [s(0.0), fy]];
        if !self.is_perfect {
            let square = y.fma(y, x * x);
            let image = self.distortion.image::<V, SLOPE>([x, y], square);
            depth = square.select_gt(self.valid_square, s(0.0), depth);
            at = image.at;
            if SLOPE {
                let [[xx, xy], [yx, yy]] = image.derivative;
                slope = [[xx * fx, xy * fx], [yx * fy, yy * fy]];
            }
        }
        Shown { depth, at, slope, inverse_depth, ideal: [x, y] }
    }

    /// `pixel` − where the point is shown, pixels.
    #[inline(always)]
    pub fn residual<V: Real>(&self, shown: &Shown<V>, pixel: [f64; 2]) -> [V; 2] {
        let s = |x: f64| V::splat(x);
        [shown.at[0].fnma(s(self.focal[0]), s(pixel[0])), shown.at[1].fnma(s(self.focal[1]), s(pixel[1]))]
    }

    /// `Jᵀ e` with J the derivative of the pixel by the point of the world.
    #[inline(always)]
    pub fn pull<V: Real>(&self, shown: &Shown<V>, e: [V; 2]) -> [V; 3] {
        let s = |x: f64| V::splat(x);
        let [[xx, xy], [yx, yy]] = shown.slope;
        let gx = e[1].fma(yx, e[0] * xx) * shown.inverse_depth;
        let gy = e[1].fma(yy, e[0] * xy) * shown.inverse_depth;
        let gz = -shown.ideal[1].fma(gy, shown.ideal[0] * gx);
        let column = |i: usize| {
            let r = &self.rotation;
            gz.fma(s(r[2][i]), gy.fma(s(r[1][i]), gx * s(r[0][i])))
        };
        [column(0), column(1), column(2)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::camera::Intrinsics;
    use crate::cameras::lens::{Fisheye, Lens, Rational};
    use sinew_core::lanes::{Block, Isa, Kernel, LANES, dispatch};

    /// A perfect lens, Brown–Conrady ones with and without a limit, rational ones, fisheye ones.
    fn lenses() -> Vec<Lens> {
        let brown = |k1, k2, k3| Brown { k1, k2, p1: 2e-3, p2: -1e-3, k3 }.into();
        let rational = |numerator, denominator| Rational { numerator, denominator, p1: 1.1e-3, p2: -7e-4 }.into();
        vec![
            Lens::default(),
            brown(-0.05, 0.03, 0.01),
            brown(-0.3, 0.0, 0.0),
            brown(0.19, -0.256, 0.115),
            rational([0.3, -0.08, 0.004], [0.62, -0.05, 0.012]),
            rational([-0.4, 0.0, 0.0], [0.1, -0.2, 0.0]),
            Fisheye { k: [-0.012, 0.021, -0.015, 0.0035] }.into(),
            Fisheye { k: [-0.2, 0.0, 0.0, 0.0] }.into(),
        ]
    }

    fn camera(lens: Lens) -> Camera {
        let camera = Camera::look_at("C", [1000.0, 1200.0], 900.0, [1.2, -4.0, 1.5], [0.0, 0.0, 1.0]).expect("a view");
        Camera { intrinsics: Intrinsics { fy: 880.0, ..camera.intrinsics }, lens, ..camera }
    }

    /// Depth, residual and pulls of both coordinates for a block of points.
    struct Seen<'a, L> {
        camera: &'a LaneCamera<L>,
        points: &'a [Block; 3],
        out: &'a mut [Block; 9],
    }

    impl<L: Distort> Kernel<Block> for Seen<'_, L> {
        #[inline(always)]
        fn run<V: Real<Mem = Block>>(&mut self) {
            let [x, y, z] = self.points;
            let shown = self.camera.show::<V, true>([V::load(x), V::load(y), V::load(z)]);
            let (zero, one) = (V::splat(0.0), V::splat(1.0));
            let [u, v] = self.camera.residual(&shown, [0.0; 2]);
            let [a, b, c] = self.camera.pull(&shown, [one, zero]);
            let [d, e, f] = self.camera.pull(&shown, [zero, one]);
            for (out, x) in self.out.iter_mut().zip([shown.depth, u, v, a, b, c, d, e, f]) {
                x.store(out);
            }
        }
    }

    fn seen(isa: Isa, camera: &Camera, points: &[Block; 3]) -> [Block; 9] {
        let mut out = [Block::ZERO; 9];
        match LaneCameras::new(std::iter::once(camera)) {
            LaneCameras::Brown(cameras) => dispatch(isa, Seen { camera: &cameras[0], points, out: &mut out }),
            LaneCameras::Mixed(cameras) => dispatch(isa, Seen { camera: &cameras[0], points, out: &mut out }),
        }
        out
    }

    /// Points around the axis of the camera, out to 80° from it, some of them behind it.
    fn points(camera: &Camera) -> Vec<[f64; 3]> {
        let [right, down, forward] = camera.rotation;
        let centre = camera.centre();
        (0..40 * LANES as u32)
            .map(|k| {
                let (angle, off) = (2.4 * f64::from(k), (0.25 * f64::from(k) % 80.0).to_radians());
                let away = if k % 13 == 0 { -2.0 } else { 1.0 + f64::from(k % 7) };
                let side = [0, 1, 2].map(|i: usize| angle.cos() * right[i] + angle.sin() * down[i]);
                [0, 1, 2].map(|i: usize| centre[i] + away * (off.cos() * forward[i] + off.sin() * side[i]))
            })
            .collect()
    }

    /// What one is shown, the other is shown, at the same place and with the same derivative, for every lens on every instruction set.
    #[test]
    fn cameras_and_lanes_agree() {
        for lens in lenses() {
            let camera = camera(lens);
            let (mut shown, mut beyond) = (0, 0);
            for points in points(&camera).as_chunks::<LANES>().0 {
                let block = [0, 1, 2].map(|k: usize| Block(points.map(|p| p[k])));
                for isa in Isa::available() {
                    let found = seen(isa, &camera, &block).map(|block| block.0);
                    for (lane, point) in points.iter().enumerate() {
                        let is_seen = found[0][lane] > MIN_DEPTH_M;
                        let expected = camera.project_with_jacobian(*point);
                        assert_eq!(is_seen, expected.is_some(), "{lens:?}: {point:?}");
                        assert_eq!(camera.project(*point).pixel(), expected.map(|(pixel, _)| pixel));
                        assert!(found.iter().all(|numbers| numbers[lane].is_finite()), "{lens:?}: {point:?}");
                        let in_front = camera.point_in_camera(*point)[2] > MIN_DEPTH_M;
                        beyond += usize::from(in_front && !is_seen);
                        let Some(([u, v], jacobian)) = expected else { continue };
                        shown += 1;
                        let (cx, cy) = (camera.intrinsics.cx, camera.intrinsics.cy);
                        assert!((cx - found[1][lane] - u).abs() < 1e-9 * (1.0 + u.abs()), "{lens:?}");
                        assert!((cy - found[2][lane] - v).abs() < 1e-9 * (1.0 + v.abs()), "{lens:?}");
                        for (k, expected) in jacobian.iter().flatten().enumerate() {
                            let largest = jacobian.iter().flatten().fold(1.0_f64, |m, x| m.max(x.abs()));
                            assert!((found[3 + k][lane] - expected).abs() < 1e-10 * largest, "{lens:?}: {k}");
                        }
                    }
                }
            }
            assert!(shown > 100, "{lens:?}: {shown}");
            assert_eq!(beyond > 0, lens.valid_radius() < f64::tan(80_f64.to_radians()), "{lens:?}: {beyond}");
        }
    }
}
