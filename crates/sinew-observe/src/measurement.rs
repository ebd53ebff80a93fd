//! Measurement points of a solid in an image: where on it the region and the edges are looked up (Husz, Wallace & Green 2007), and which of them are seen.
//!
//! Between the two generators of the occluding contour, G−(u) and G+(u) with u from base to top, region points are (1 − w) G+(u) + w G−(u) in the image on a grid of [`ROWS`] by [`ACROSS`] cell centres, and edge points are
//! [`ALONG`] cell centres of each generator. Caps carry no edge points.
//!
//! A point is hidden where a solid that may hide it covers its pixel. Two rules ([`Hiding`]): solids whose centres are nearer hide what is behind them, but near a joint not what hangs on them; or any other solid hides, which
//! leaves the outer contour.

use crate::bit_image::BitImage;
use crate::map::Map;
use crate::outline::{Outline, round, whole};
use crate::raster::Spans;
use sinew_core::lanes::{Block, Kernel, LANES, Real};

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
pub struct Tally {
    /// Points in the image that are not hidden.
    pub inside: u32,
    /// Points out of the image.
    pub outside: u32,
    /// Sum of (1 − p)² over the points inside, p the value of the map, from 0 to 1.
    pub misses: f64,
}

impl Tally {
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
    pub points: &'a mut Points,
}

/// The pixel that a place lies in is that whose centre is nearest.
#[inline(always)]
fn pixel<V: Real<Mem = Block>>(at: [V; 2], out: &mut [Block; 2]) {
    at.into_iter().zip(out).for_each(|(x, out)| round(x, 1.0, -0.5).store(out));
}

impl Kernel<Block> for Place<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let ends = self.outline.generators.each_ref().map(|generator| {
            let [base, top] = generator.each_ref().map(|end| end.each_ref().map(V::load));
            [base, [0, 1, 2].map(|k: usize| top[k] - base[k])]
        });
        let along = |[base, arm]: [[V; 3]; 2], u: f64| {
            let [x, y, depth] = [0, 1, 2].map(|k: usize| arm[k].fma(V::splat(u), base[k]));
            let inverse = V::splat(1.0) / depth;
            [x * inverse, y * inverse]
        };
        for (row, points) in self.points.region.as_chunks_mut::<ACROSS>().0.iter_mut().enumerate() {
            let [minus, plus] = ends.map(|end| along(end, (row as f64 + 0.5) / ROWS as f64));
            let across = [0, 1].map(|k: usize| minus[k] - plus[k]);
            for (column, point) in points.iter_mut().enumerate() {
                let w = V::splat((column as f64 + 0.5) / ACROSS as f64);
                pixel([0, 1].map(|k: usize| across[k].fma(w, plus[k])), point);
            }
        }
        for (points, end) in self.points.edges.as_chunks_mut::<ALONG>().0.iter_mut().zip(ends) {
            for (k, point) in points.iter_mut().enumerate() {
                pixel(along(end, (k as f64 + 0.5) / ALONG as f64), point);
            }
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
    fn hide(self, at_joint: bool, spans: &[Spans], x: i32, y: i32) -> bool {
        let mut left = if at_joint { self.ends } else { self.middle };
        while left != 0 {
            let hider = left.trailing_zeros() as usize;
            if spans.get(hider).is_some_and(|spans| spans.covers(x, y)) {
                return true;
            }
            left &= left - 1;
        }
        false
    }
}

/// Adds up (1 − p)² at some points.
#[inline(always)]
fn look_up(
    points: &[[Block; 2]],
    lane: usize,
    (width, height): (usize, usize),
    is_hidden: impl Fn(usize, i32, i32) -> bool,
    value: impl Fn(usize, usize) -> f64,
) -> Tally {
    let mut tally = Tally::default();
    for (k, point) in points.iter().enumerate() {
        let [x, y] = point.map(|x| whole(x.0[lane]));
        let (column, row) = (x as usize, y as usize);
        if column >= width || row >= height {
            tally.outside += 1;
        } else if !is_hidden(k, x, y) {
            tally.inside += 1;
            tally.misses += value(column, row);
        }
    }
    tally
}

impl Points {
    /// Looks the region up in a silhouette.
    #[inline(always)]
    pub fn region(&self, lane: usize, silhouette: &BitImage, hiders: Hiders, spans: &[Spans]) -> Tally {
        let size = (silhouette.width(), silhouette.height());
        let is_hidden = |k: usize, x, y| hiders.hide(is_at_joint(k / ACROSS, ROWS), spans, x, y);
        look_up(&self.region, lane, size, is_hidden, |x, y| if silhouette.get(x, y) { 0.0 } else { 1.0 })
    }

    /// Looks the edges up in a map.
    #[inline(always)]
    pub fn edges(&self, lane: usize, map: &Map, hiders: Hiders, spans: &[Spans]) -> Tally {
        let is_hidden = |k: usize, x, y| hiders.hide(is_at_joint(k % ALONG, ALONG), spans, x, y);
        look_up(&self.edges, lane, (map.width, map.height), is_hidden, |x, y| {
            let miss = 1.0 - f64::from(map.get(x, y).unwrap_or_default());
            miss * miss
        })
    }

    /// Pixels of the region that are not hidden and in an image of some size.
    #[inline(always)]
    pub fn visible_region(
        &self,
        lane: usize,
        (width, height): (usize, usize),
        hiders: Hiders,
        spans: &[Spans],
        mut each: impl FnMut(usize, usize),
    ) {
        for (k, point) in self.region.iter().enumerate() {
            let [x, y] = point.map(|x| whole(x.0[lane]));
            let (column, row) = (x as usize, y as usize);
            if column < width && row < height && !hiders.hide(is_at_joint(k / ACROSS, ROWS), spans, x, y) {
                each(column, row);
            }
        }
    }
}

const _: () = assert!(LANES == 8 && u32::BITS >= 32);
