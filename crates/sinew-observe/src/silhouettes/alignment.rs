//! Global alignment of a body with silhouettes (Husz, Wallace & Green 2007, eq. 10).
//!
//! In each view, within the bounding box of the projected body with a quarter of its width and height added on each side and cut off at the image's border,
//!
//! log λ_G = −(1/σ) Σ_views n_mismatch / n_nonbg, σ = 0.25,
//!
//! n_mismatch = pixels of the silhouette that the body leaves uncovered, n_nonbg = pixels of the silhouette or of the body. Where there is neither, the ratio is 1. A pixel is in the box if its centre is.
//!
//! A flaw of the formula: mismatches are counted in the body's own box alone, so that a body away from the person has the largest value of all, 0. Whoever looks for the best body asks first in how many views it meets the
//! silhouette ([`Global::met`]).
//!
//! The body's pixels lie in its box, so that the silhouette is counted in the box once, and with the body's bits only in the columns that the body has.

use crate::silhouettes::bit_image::{BitImage, overlap};
use crate::silhouettes::image_likelihood::ImageLikelihood;
use crate::silhouettes::image_lookup::{Body, Scratch, draw_union};
use crate::silhouettes::outline::{Outline, whole};
use crate::silhouettes::raster::PARTS;
use core::ops::Range;
use sinew_core::density::Global;
use sinew_core::lanes::{Block, Kernel, LANES, Real, dispatch, dispatch_one};

/// σ of the paper.
pub const SIGMA: f64 = 0.25;

/// Pixels of a silhouette and of a body in the body's box.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Aligned {
    /// Of both.
    pub both: u64,
    /// Of the silhouette alone: n_mismatch.
    pub mismatch: u64,
    /// Of either: n_nonbg.
    pub either: u64,
}

impl Aligned {
    /// n_mismatch / n_nonbg, from 0 to 1.
    #[inline(always)]
    #[must_use]
    pub fn ratio(self) -> f64 {
        if self.either == 0 { 1.0 } else { self.mismatch as f64 / self.either as f64 }
    }
}

impl ImageLikelihood {
    /// log λ_G of eight bodies over all views that saw something, and in how many of these each covers a pixel of the silhouette; d blocks.
    #[must_use]
    pub fn alignment_block(&self, x: &[Block]) -> Global {
        let mut out = Global { log_likelihood: Block::ZERO, met: Block::ZERO };
        self.aligned_block(x, |_, views| {
            for (lane, view) in views.iter().enumerate() {
                out.log_likelihood.0[lane] -= view.ratio() / SIGMA;
                out.met.0[lane] += f64::from(u8::from(view.both > 0));
            }
        });
        out
    }

    /// Pixels of the silhouette and of each of eight bodies in their boxes, view by view; d blocks.
    pub fn aligned_block(&self, x: &[Block], mut each: impl FnMut(usize, &[Aligned; LANES])) {
        let isa = self.isa();
        self.each_view(x, |scratch, camera, silhouette| {
            let (mut bounds, mut out) = ([Block::ZERO; 4], [Aligned::default(); LANES]);
            dispatch(isa, Bounds { outlines: &scratch.outlines, out: &mut bounds });
            let Scratch { bodies, image, .. } = scratch;
            image.fit(silhouette);
            dispatch_one(isa, Align { bodies, bounds: &bounds, silhouette, image, out: &mut out });
            each(camera, &out);
        });
    }
}

/// Finds the least x and y of all solids that are seen and the largest, in parts of a pixel as [`whole`] reads them. Without any the least are larger than the largest.
struct Bounds<'a> {
    outlines: &'a [Outline],
    out: &'a mut [Block; 4],
}

impl Kernel<Block> for Bounds<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let none = V::splat(-f64::MAX);
        let mut far = [none; 4];
        for outline in self.outlines {
            let [left, up, right, down] = &outline.bounds;
            let own = [-V::load(left), -V::load(up), V::load(right), V::load(down)];
            let seen = V::load(&outline.nearest) - V::splat(crate::MIN_DEPTH_M);
            let mut k = 0;
            while k < 4 {
                far[k] = far[k].max(seen.select_gt(0.0, own[k], none));
                k += 1;
            }
        }
        let [left, up, right, down] = far;
        (-left).store(&mut self.out[0]);
        (-up).store(&mut self.out[1]);
        right.store(&mut self.out[2]);
        down.store(&mut self.out[3]);
    }
}

/// Columns or rows whose centres lie between two places with a quarter of their distance on either side, in an image of `size`.
#[inline(always)]
fn widened(least: i32, most: i32, size: usize) -> Range<usize> {
    // Four parts of a part of a pixel, so that a quarter is whole.
    let (width, pixel) = (i64::from(most) - i64::from(least), i64::from(4 * PARTS));
    let centre = pixel / 2;
    let first = (4 * i64::from(least) - width - centre + pixel - 1).div_euclid(pixel);
    let end = (4 * i64::from(most) + width - centre).div_euclid(pixel) + 1;
    let size = size as i64;
    first.clamp(0, size) as usize..end.clamp(0, size) as usize
}

/// Counts the pixels of each body and of the silhouette in the body's box.
struct Align<'a> {
    bodies: &'a [Body; LANES],
    bounds: &'a [Block; 4],
    silhouette: &'a BitImage,
    image: &'a mut BitImage,
    out: &'a mut [Aligned; LANES],
}

impl Kernel<f64> for Align<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = f64>>(&mut self) {
        let (silhouette, [left, up, right, down]) = (self.silhouette, self.bounds);
        for (lane, (body, out)) in self.bodies.iter().zip(&mut *self.out).enumerate() {
            *out = Aligned::default();
            if body.seen == 0 {
                continue;
            }
            let columns = widened(whole(left.0[lane]), whole(right.0[lane]), silhouette.width());
            let rows = widened(whole(up.0[lane]), whole(down.0[lane]), silhouette.height());
            let in_box = silhouette.count_inside(columns, rows);
            let covered = draw_union(body, self.image);
            let pixels = overlap(silhouette, self.image, covered);
            out.both = pixels.both;
            out.mismatch = in_box - pixels.both;
            out.either = in_box + pixels.second_only;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every place of both ends, by the rule itself.
    #[test]
    fn a_box_has_the_pixels_whose_centres_are_in_it() {
        for least in (-3000..3000).step_by(37) {
            for width in (0..4000).step_by(113) {
                let (low, high) = (f64::from(least) / 256.0, f64::from(least + width) / 256.0);
                let quarter = 0.25 * (high - low);
                let inside = |k: &usize| low - quarter <= *k as f64 + 0.5 && *k as f64 + 0.5 <= high + quarter;
                let expected: Vec<usize> = (0..9).filter(inside).collect();
                let found: Vec<usize> = widened(least, least + width, 9).collect();
                assert_eq!(found, expected, "{least} and {width} more");
            }
        }
    }

    #[test]
    fn ratios_are_as_in_the_paper() {
        assert_eq!(Aligned::default().ratio(), 1.0);
        assert_eq!(Aligned { both: 5, mismatch: 0, either: 7 }.ratio(), 0.0);
        assert_eq!(Aligned { both: 0, mismatch: 3, either: 12 }.ratio(), 0.25);
    }
}
