//! Measurement points of a solid in an image, and which of them are seen. Region and edges are looked up there (Husz, Wallace & Green 2007).
//!
//! Between the two generators of the occluding contour, G−(u) and G+(u) with u from base to top, region points are (1 − w) G+(u) + w G−(u) in the image on a grid of [`ROWS`] by [`ACROSS`] cell centres, and edge points are
//! [`ALONG`] cell centres of each generator. Caps carry no edge points.
//!
//! A point is hidden where a solid that may hide it covers its pixel. Two rules ([`Hiding`]): solids whose centres are nearer hide what is behind them, but near a joint not what hangs on them; or any other solid hides, which
//! leaves the outer contour.

use crate::RgbImage;
use crate::silhouettes::bit_image::BitImage;
use crate::silhouettes::colour_histogram::Counts;
use crate::silhouettes::map::Map;
use crate::silhouettes::outline::{Outline, along, load, round, whole};
use crate::silhouettes::raster::Spans;
use sinew_core::lanes::{Block, Kernel, Real};

/// Rows of region points, from base to top.
const ROWS: usize = 10;
/// Region points of a row.
const ACROSS: usize = 6;
/// Region points of a solid.
pub const REGION_POINTS: usize = ROWS * ACROSS;
/// Edge points of a generator.
const ALONG: usize = 12;
/// Edge points of a solid.
pub const EDGE_POINTS: usize = 2 * ALONG;
/// Parts of the length at each end within which what hangs together does not hide each other.
const JOINT: f64 = 0.15;

/// What hides a measurement point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hiding {
    /// Solids with a nearer centre, but near joints not those that hang together (Husz, Wallace & Green 2007).
    Nearer,
    /// Every other solid hides edge points, none hides region points: the contour of the whole body.
    Others,
}

/// What was looked up at the points of a solid for one cue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointTally {
    /// Points in the image that are not hidden.
    pub inside: u32,
    /// Points out of the image.
    pub outside: u32,
    /// Sum of (1 − p)² over the points inside, p the value of the map, from 0 to 1.
    pub misses: f64,
}

impl PointTally {
    /// Adds another solid's.
    #[inline(always)]
    pub fn add(&mut self, other: Self) {
        self.inside += other.inside;
        self.outside += other.outside;
        self.misses += other.misses;
    }

    /// Mean of (1 − p)², a point out of the image counting as 1; without points as given.
    #[inline(always)]
    #[must_use]
    pub fn mean_or(&self, otherwise: f64) -> f64 {
        let points = f64::from(self.inside + self.outside);
        if points > 0.0 { (self.misses + f64::from(self.outside)) / points } else { otherwise }
    }
}

/// Pixels of the measurement points of one solid of a block of bodies, as [`whole`] reads them.
#[derive(Clone, Debug)]
pub(crate) struct Points {
    region: [[Block; 2]; REGION_POINTS],
    edges: [[Block; 2]; EDGE_POINTS],
}

impl Points {
    pub const EMPTY: Self = Self { region: [[Block::ZERO; 2]; REGION_POINTS], edges: [[Block::ZERO; 2]; EDGE_POINTS] };
}

/// Places the points of a solid whose outline is known.
pub(crate) struct Place<'a> {
    pub outline: &'a Outline,
    /// Whether region points are wanted, too.
    pub with_region: bool,
    pub points: &'a mut Points,
}

/// A generator from its base, and its direction, times the camera's matrix.
#[derive(Clone, Copy)]
struct Generator<V> {
    base: [V; 3],
    arm: [V; 3],
}

impl<V: Real<Mem = Block>> Generator<V> {
    #[inline(always)]
    fn load([base, top]: &[[Block; 3]; 2]) -> Self {
        let (base, top) = (load::<V>(base), load::<V>(top));
        Self { base, arm: [top[0] - base[0], top[1] - base[1], top[2] - base[2]] }
    }

    /// Its place in the image at a part of its length.
    #[inline(always)]
    fn at(&self, u: f64) -> [V; 2] {
        let [x, y, depth] = along(V::splat(u), self.arm, self.base);
        let inverse = V::splat(1.0) / depth;
        [x * inverse, y * inverse]
    }
}

/// The pixel that a place lies in is that whose centre is nearest.
#[inline(always)]
fn pixel<V: Real<Mem = Block>>([x, y]: [V; 2], out: &mut [Block; 2]) {
    round(x, 1.0, -0.5).store(&mut out[0]);
    round(y, 1.0, -0.5).store(&mut out[1]);
}

impl Kernel<Block> for Place<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let [minus_ends, plus_ends] = &self.outline.generators;
        let (minus, plus) = (Generator::<V>::load(minus_ends), Generator::<V>::load(plus_ends));
        let rows = if self.with_region { ROWS } else { 0 };
        for (row, points) in self.points.region.as_chunks_mut::<ACROSS>().0.iter_mut().take(rows).enumerate() {
            let u = (row as f64 + 0.5) / ROWS as f64;
            let ([ax, ay], [bx, by]) = (plus.at(u), minus.at(u));
            for (column, point) in points.iter_mut().enumerate() {
                let w = V::splat((column as f64 + 0.5) / ACROSS as f64);
                pixel([w.fma(bx - ax, ax), w.fma(by - ay, ay)], point);
            }
        }
        let (minus_points, plus_points) = self.points.edges.split_at_mut(ALONG);
        for (k, (at_minus, at_plus)) in minus_points.iter_mut().zip(plus_points).enumerate() {
            let u = (k as f64 + 0.5) / ALONG as f64;
            pixel(minus.at(u), at_minus);
            pixel(plus.at(u), at_plus);
        }
    }
}

const fn is_at_joint(step: usize, steps: usize) -> bool {
    let u = (step as f64 + 0.5) / steps as f64;
    u < JOINT || u > 1.0 - JOINT
}

/// Which solids may hide a solid's points: bit k stands for solid k.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hiders {
    /// Along the middle of it.
    pub middle: u32,
    /// Near its ends.
    pub ends: u32,
}

impl Hiders {
    #[inline(always)]
    fn at(self, joint: bool) -> u32 {
        if joint { self.ends } else { self.middle }
    }
}

/// Whether one of a set of solids covers a pixel.
#[inline(always)]
fn is_hidden(mut hiders: u32, spans: &[Spans], x: i32, y: i32) -> bool {
    while hiders != 0 {
        let hider = hiders.trailing_zeros() as usize;
        if spans.get(hider).is_some_and(|spans| spans.covers(x, y)) {
            return true;
        }
        hiders &= hiders - 1;
    }
    false
}

/// A pixel of a block of bodies in one lane, and whether it is in an image.
#[inline(always)]
fn in_lane([x, y]: &[Block; 2], lane: usize, [width, height]: [usize; 2]) -> (i32, i32, bool) {
    let (x, y) = (whole(x.0[lane]), whole(y.0[lane]));
    (x, y, (x as usize) < width && (y as usize) < height)
}

impl Points {
    /// Looks the region up in a silhouette.
    #[inline(always)]
    pub fn region(&self, lane: usize, silhouette: &BitImage, hiders: Hiders, spans: &[Spans]) -> PointTally {
        let size = [silhouette.width(), silhouette.height()];
        let (mut inside, mut outside, mut hits) = (0, 0, 0);
        for (row, points) in self.region.as_chunks::<ACROSS>().0.iter().enumerate() {
            let may_hide = hiders.at(is_at_joint(row, ROWS));
            for point in points {
                let (x, y, is_inside) = in_lane(point, lane, size);
                if !is_inside {
                    outside += 1;
                } else if may_hide == 0 || !is_hidden(may_hide, spans, x, y) {
                    inside += 1;
                    hits += u32::from(silhouette.is_set_inside(x as usize, y as usize));
                }
            }
        }
        PointTally { inside, outside, misses: f64::from(inside - hits) }
    }

    /// Looks the edges up in a map.
    #[inline(always)]
    pub fn edges(&self, lane: usize, map: &Map, hiders: Hiders, spans: &[Spans]) -> PointTally {
        let size = [map.width, map.height];
        let (mut inside, mut outside, mut misses) = (0, 0, 0.0);
        for points in self.edges.as_chunks::<ALONG>().0 {
            for (k, point) in points.iter().enumerate() {
                let may_hide = hiders.at(is_at_joint(k, ALONG));
                let (x, y, is_inside) = in_lane(point, lane, size);
                if !is_inside {
                    outside += 1;
                } else if may_hide == 0 || !is_hidden(may_hide, spans, x, y) {
                    let value = map.values.get(y as usize * map.width + x as usize).copied().unwrap_or_default();
                    let miss = 1.0 - f64::from(value);
                    inside += 1;
                    misses += miss * miss;
                }
            }
        }
        PointTally { inside, outside, misses }
    }

    /// Counts the colours of the pixels of the region that are in the picture and not hidden.
    #[inline(always)]
    pub fn colours(&self, lane: usize, picture: &RgbImage, hiders: Hiders, spans: &[Spans], counts: &mut Counts) {
        let size = [picture.width, picture.height];
        for (row, points) in self.region.as_chunks::<ACROSS>().0.iter().enumerate() {
            let may_hide = hiders.at(is_at_joint(row, ROWS));
            for point in points {
                let (x, y, is_inside) = in_lane(point, lane, size);
                if is_inside && !is_hidden(may_hide, spans, x, y) {
                    let at = y as usize * picture.width + x as usize;
                    counts.add(picture.pixels.get(at).copied().unwrap_or_default());
                }
            }
        }
    }
}
