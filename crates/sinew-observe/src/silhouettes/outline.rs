//! Outlines of truncated cones in a camera's image, eight bodies at a time.
//!
//! A [`Frustum`] is convex, so its image is bounded by parts of the rims of its two ends and by its two occluding generators ([`sinew_body::frustum`]). A rim is part of the outline where one of cap and side is seen and the other
//! is not: the eye sees the side between the generators v− and v+, and an end's cap when it is beyond that end's plane. So an end that shows its cap has the far arc of its rim in the outline, the other the near one, and no
//! points need to be sorted: from v− along the base's arc to v+, up that generator, along the top's arc back to v−. Seen by a camera this goes counter-clockwise.
//!
//! Where no generator is seen edge-on, the outline is the whole rim of one end, a polygon of twelve corners.

use crate::cameras::camera::{Camera, MIN_DEPTH_M};
use crate::silhouettes::raster::{FURTHEST, PARTS};
use core::f64::consts::{FRAC_PI_2, PI};
use sinew_body::frustum::Frustum;
use sinew_core::elementary::sin_cos;
use sinew_core::lanes::{Block, Kernel, ROUND_MAGIC, Real};

/// Chords of each end's arc: as many as half of a polygon of 24 corners has.
const CHORDS: usize = 12;
/// Corners of an outline.
pub(crate) const CORNERS: usize = 2 * (CHORDS + 1);

/// Blocks of a solid's frame: the centre of its base, the ends of its unit vectors x and y, the centre of its top, world coordinates.
pub(crate) const FRAME: usize = 12;

/// What is kept of each solid in one view.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outline {
    /// Corners in parts of a pixel, as [`whole`] reads them.
    pub corners: [[Block; 2]; CORNERS],
    /// Ends of the generators v− and v+, base then top, times the camera's matrix.
    pub generators: [[[Block; 3]; 2]; 2],
    /// Depth of the centre, metres.
    pub depth: Block,
    /// Least depth of the outline, metres.
    pub nearest: Block,
    /// Whether there are generators: 1 or 0.
    pub has_sides: Block,
    /// Least x and y of the corners, then the largest, in parts of a pixel as [`whole`] reads them.
    pub bounds: [Block; 4],
}

impl Outline {
    pub const EMPTY: Self = Self {
        corners: [[Block::ZERO; 2]; CORNERS],
        generators: [[[Block::ZERO; 3]; 2]; 2],
        depth: Block::ZERO,
        nearest: Block::ZERO,
        has_sides: Block::ZERO,
        bounds: [Block::ZERO; 4],
    };

    /// Whether a body's solid is in front of the camera as a whole.
    #[inline(always)]
    pub fn is_seen(&self, lane: usize) -> bool {
        self.nearest.0[lane] > MIN_DEPTH_M
    }

    /// Its bounds in one lane: least x and y, largest x and y.
    #[inline(always)]
    pub fn bounds(&self, lane: usize) -> [i32; 4] {
        let [left, up, right, down] = &self.bounds;
        [whole(left.0[lane]), whole(up.0[lane]), whole(right.0[lane]), whole(down.0[lane])]
    }

    /// Its corners in one lane.
    #[inline(always)]
    pub fn corners(&self, lane: usize) -> [[i32; 2]; CORNERS] {
        let mut corners = [[0; 2]; CORNERS];
        for (corner, [x, y]) in corners.iter_mut().zip(&self.corners) {
            *corner = [whole(x.0[lane]), whole(y.0[lane])];
        }
        corners
    }
}

/// The whole number that a lane has rounded to.
#[inline(always)]
pub(crate) fn whole(rounded: f64) -> i32 {
    rounded.to_bits() as u32 as i32
}

/// Moves what is beyond a bound on either side to the bound.
#[inline(always)]
fn within<V: Real>(x: V, bound: f64) -> V {
    let above = x.max(V::splat(-bound));
    -((-above).max(V::splat(-bound)))
}

/// Rounds to the nearest whole number, for [`whole`] to read; what is too far out is moved there.
#[inline(always)]
pub(crate) fn round<V: Real>(x: V, per_pixel: f64, shift: f64) -> V {
    within(x, FURTHEST).fma(V::splat(per_pixel), V::splat(shift)) + V::splat(ROUND_MAGIC)
}

/// What of a camera an outline needs: its matrix K \[R | t\] with a perfect lens, and where it stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    matrix: [[f64; 4]; 3],
    centre: [f64; 3],
}

impl Eye {
    pub fn of(camera: &Camera) -> Self {
        Self { matrix: camera.matrix(), centre: camera.centre() }
    }

    #[inline(always)]
    fn direction<V: Real>(&self, d: [V; 3]) -> [V; 3] {
        [row(&self.matrix[0], d), row(&self.matrix[1], d), row(&self.matrix[2], d)]
    }

    #[inline(always)]
    fn point<V: Real>(&self, p: [V; 3]) -> [V; 3] {
        let [u, v, w] = self.direction(p);
        let [a, b, c] = &self.matrix;
        [u + V::splat(a[3]), v + V::splat(b[3]), w + V::splat(c[3])]
    }
}

// Closures and `map` of arrays are left out of what runs in lanes: they are not inlined into the entry points of the instruction sets.

#[inline(always)]
fn row<V: Real>([a, b, c, _]: &[f64; 4], d: [V; 3]) -> V {
    d[2].fma(V::splat(*c), d[1].fma(V::splat(*b), d[0] * V::splat(*a)))
}

/// Projects all solids of a block of bodies into one camera.
pub(crate) struct Project<'a> {
    pub eye: &'a Eye,
    pub solids: &'a [Frustum],
    /// [`FRAME`] blocks a solid.
    pub frames: &'a [Block],
    pub out: &'a mut [Outline],
}

#[inline(always)]
fn dot<V: Real>(a: [V; 3], b: [V; 3]) -> V {
    a[2].fma(b[2], a[1].fma(b[1], a[0] * b[0]))
}

#[inline(always)]
fn sub<V: Real>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn scaled<V: Real>([x, y, z]: [V; 3], by: f64) -> [V; 3] {
    [x * V::splat(by), y * V::splat(by), z * V::splat(by)]
}

#[inline(always)]
pub(crate) fn load<V: Real<Mem = Block>>(blocks: &[Block; 3]) -> [V; 3] {
    [V::load(&blocks[0]), V::load(&blocks[1]), V::load(&blocks[2])]
}

#[inline(always)]
fn store<V: Real<Mem = Block>>([x, y, z]: [V; 3], out: &mut [Block; 3]) {
    x.store(&mut out[0]);
    y.store(&mut out[1]);
    z.store(&mut out[2]);
}

/// `a` where `switch` > 0, else `b`.
#[inline(always)]
fn either<V: Real>(switch: V, a: [V; 3], b: [V; 3]) -> [V; 3] {
    [switch.select_gt(0.0, a[0], b[0]), switch.select_gt(0.0, a[1], b[1]), switch.select_gt(0.0, a[2], b[2])]
}

/// `x · direction + centre`, coordinate by coordinate.
#[inline(always)]
pub(crate) fn along<V: Real>(x: V, direction: [V; 3], centre: [V; 3]) -> [V; 3] {
    [x.fma(direction[0], centre[0]), x.fma(direction[1], centre[1]), x.fma(direction[2], centre[2])]
}

/// Angle with this cosine to some 10⁻⁴ (Abramowitz & Stegun 4.4.45): it only spaces the corners between the ends of an arc.
#[inline(always)]
fn arc_cosine<V: Real>(q: V) -> V {
    let size = q.max(-q);
    let root = (V::splat(1.0) - size).max(V::splat(0.0)).sqrt();
    let sum = size.fma(V::splat(-0.018_729_3), V::splat(0.074_261_0));
    let sum = size.fma(size.fma(sum, V::splat(-0.212_114_4)), V::splat(FRAC_PI_2));
    q.select_gt(0.0, root * sum, root.fnma(sum, V::splat(PI)))
}

/// A point on a rim: the ellipse about `centre` with the half axes `x` and `y`.
#[derive(Clone, Copy)]
struct Rim<V> {
    centre: [V; 3],
    x: [V; 3],
    y: [V; 3],
}

impl<V: Real> Rim<V> {
    #[inline(always)]
    fn at(&self, [cos, sin]: [V; 2]) -> [V; 3] {
        along(sin, self.y, along(cos, self.x, self.centre))
    }

    /// This one where `switch` > 0, else the other.
    #[inline(always)]
    fn or(&self, other: &Self, switch: V) -> Self {
        Self {
            centre: either(switch, self.centre, other.centre),
            x: either(switch, self.x, other.x),
            y: either(switch, self.y, other.y),
        }
    }
}

/// Least depth of an arc, and how far its corners reach to the left, up, right and down.
type Reach<V> = [V; 5];

/// The larger reach of two; of the depths the lesser.
#[inline(always)]
fn further<V: Real>(a: Reach<V>, b: Reach<V>) -> Reach<V> {
    [-((-a[0]).max(-b[0])), a[1].max(b[1]), a[2].max(b[2]), a[3].max(b[3]), a[4].max(b[4])]
}

/// Writes the corners of an arc from one direction to another by equal steps; gives its reach. Corners between the ends stand out so far that the polygon has the area of the ellipse's sector: by √(θ/sin θ) for chords of θ.
#[inline(always)]
fn arc<V: Real<Mem = Block>>(rim: &Rim<V>, [from, to]: [[V; 2]; 2], step: V, out: &mut [[Block; 2]]) -> Reach<V> {
    let (sin, cos) = sin_cos(step);
    let square = step * step;
    let out_by = square.fma(square.fma(V::splat(1.0 / 160.0), V::splat(1.0 / 12.0)), V::splat(1.0));
    let none = V::splat(-f64::MAX);
    let (mut at, mut reach) = (from, [V::splat(f64::MAX), none, none, none, none]);
    let last = out.len() - 1;
    for (k, corner) in out.iter_mut().enumerate() {
        let direction = match k {
            0 => from,
            k if k == last => to,
            _ => [at[0] * out_by, at[1] * out_by],
        };
        let [u, v, depth] = rim.at(direction);
        let inverse = V::splat(1.0) / depth;
        let (x, y) = (round(u * inverse, f64::from(PARTS), 0.0), round(v * inverse, f64::from(PARTS), 0.0));
        x.store(&mut corner[0]);
        y.store(&mut corner[1]);
        reach = further(reach, [depth, -x, -y, x, y]);
        at = [at[1].fnma(sin, at[0] * cos), at[1].fma(cos, at[0] * sin)];
    }
    reach
}

impl Kernel<Block> for Project<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let (frames, _) = self.frames.as_chunks::<FRAME>();
        let [cx, cy, cz] = self.eye.centre;
        for ((solid, frame), out) in self.solids.iter().zip(frames).zip(&mut *self.out) {
            let (points, _) = frame.as_chunks::<3>();
            let (base, top) = (load::<V>(&points[0]), load::<V>(&points[3]));
            let (x, y) = (sub(load(&points[1]), base), sub(load(&points[2]), base));
            let z = scaled(sub(top, base), 1.0 / solid.height);
            let sight = sub([V::splat(cx), V::splat(cy), V::splat(cz)], base);
            let (ex, ey, ez) = (dot(sight, x), dot(sight, y) * V::splat(1.0 / solid.ratio), dot(sight, z));
            let radius = ez.fma(V::splat(solid.slope()), V::splat(solid.radii[0]));
            let away = ey.fma(ey, ex * ex).max(V::splat(f64::MIN_POSITIVE)).sqrt();
            let inverse = V::splat(1.0) / away;
            let [toward_cos, toward_sin] = [ex * inverse, ey * inverse];
            let q = radius * inverse;
            let sides = q.fnma(q, V::splat(1.0));
            let s = sides.max(V::splat(0.0)).sqrt();
            let q = within(q, 1.0);
            let minus = [toward_sin.fma(s, toward_cos * q), toward_cos.fnma(s, toward_sin * q)];
            let plus = [toward_sin.fnma(s, toward_cos * q), toward_cos.fma(s, toward_sin * q)];

            let (px, py) = (self.eye.direction(x), self.eye.direction(y));
            let [low_radius, high_radius] = solid.radii;
            let low = Rim {
                centre: self.eye.point(base),
                x: scaled(px, low_radius),
                y: scaled(py, solid.ratio * low_radius),
            };
            let high = Rim {
                centre: self.eye.point(top),
                x: scaled(px, high_radius),
                y: scaled(py, solid.ratio * high_radius),
            };
            let [minus_ends, plus_ends] = &mut out.generators;
            store(low.at(minus), &mut minus_ends[0]);
            store(high.at(minus), &mut minus_ends[1]);
            store(low.at(plus), &mut plus_ends[0]);
            store(high.at(plus), &mut plus_ends[1]);
            let near = arc_cosine(q) * V::splat(2.0);
            let far = near - V::splat(2.0 * PI);
            let low_arc = ez.select_gt(0.0, near, far);
            let high_arc = ez.select_gt(solid.height, -far, -near);
            // Without sides one arc is a whole rim and the other a point, which must not stick out of it.
            let whole_low = low_arc * low_arc - high_arc * high_arc;
            let is_round = V::splat(1.0);
            let low_used = sides.select_gt(0.0, is_round, whole_low);
            let high_used = sides.select_gt(0.0, is_round, -whole_low);
            let (used_low, used_high) = (low.or(&high, low_used), high.or(&low, high_used));
            let per_chord = V::splat(1.0 / CHORDS as f64);
            let (low_corners, high_corners) = out.corners.split_at_mut(CHORDS + 1);
            let a = arc(&used_low, [minus, plus], low_arc * per_chord, low_corners);
            let b = arc(&used_high, [plus, minus], high_arc * per_chord, high_corners);
            let [nearest, left, up, right, down] = further(a, b);
            nearest.store(&mut out.nearest);
            (-left).store(&mut out.bounds[0]);
            (-up).store(&mut out.bounds[1]);
            right.store(&mut out.bounds[2]);
            down.store(&mut out.bounds[3]);
            ((low.centre[2] + high.centre[2]) * V::splat(0.5)).store(&mut out.depth);
            sides.select_gt(0.0, V::splat(1.0), V::splat(0.0)).store(&mut out.has_sides);
        }
    }
}
