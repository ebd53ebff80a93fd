//! Convex polygons into [`BitImage`]s.
//!
//! Pixel (x, y) has its centre at (x + ½, y + ½); x goes right and y down. It is covered where its centre lies inside the polygon. A centre on an edge counts if the edge is a left or a top one, so that of two polygons which
//! share an edge exactly one has the pixel. Corners are first rounded to 1/256 pixel; what follows has the outcome of whole numbers.
//!
//! An edge that is not vertical bounds the span of every column whose centre it crosses. In parts of a pixel, with dx > 0, it crosses the column whose centre is at x at y₀ + (x − x₀) dy/dx, and the first row whose centre
//! is there or below is ⌊(n − 1)/d⌋ + 1 of whole numbers n/d = that height in pixels; the first row strictly below is ⌊n/d⌋ + 1. Floating-point numbers give the same: ½ is added to the numerator, so that no quotient is
//! nearer to a whole number than ½/d, which is far more than their error.

use crate::silhouettes::bit_image::BitImage;
use sinew_core::lanes::ROUND_MAGIC;
use std::ops::Range;

/// Parts of a pixel that corners are rounded to.
pub(crate) const PARTS: i32 = 256;
/// Corners further from the image's origin than this many pixels are moved there, so that quotients are exact.
pub(crate) const FURTHEST: f64 = 16_384.0;

/// Rows of each column that a convex polygon covers; kept to be used again.
#[derive(Clone, Debug, Default)]
pub struct Spans {
    first: usize,
    rows: Vec<[i32; 2]>,
}

/// The first column of an image whose centre is at or right of a place in parts of a pixel.
#[inline(always)]
fn column_from(place: i32, width: i32) -> i32 {
    (place + PARTS / 2 - 1).div_euclid(PARTS).clamp(0, width)
}

/// The nearest whole number, for sizes below 2³¹.
#[inline(always)]
fn nearest(x: f64) -> i32 {
    (x + ROUND_MAGIC).to_bits() as u32 as i32
}

/// Where an edge crosses columns: at `start` in the first, so much lower in each.
#[derive(Clone, Copy)]
struct Edge {
    start: f64,
    slope: f64,
}

impl Edge {
    /// Between two corners, from the column whose number is given. On an edge that is `inside` a centre counts as covered: a left one, which goes down, or a level one that goes to the left.
    #[inline(always)]
    fn new(left: [i32; 2], right: [i32; 2], inside: bool, column: i32, is_upper: bool) -> Self {
        let (dx, dy) = (f64::from(right[0] - left[0]), f64::from(right[1] - left[1]));
        let parts = f64::from(PARTS);
        let per_part = 1.0 / (parts * dx);
        let x = f64::from(PARTS * column + PARTS / 2 - left[0]);
        let numerator = (f64::from(left[1]) - 0.5 * parts) * dx + x * dy;
        // The first row at the edge or below it, or strictly below it.
        let shift = if inside == is_upper { -0.5 } else { 0.5 };
        Self { start: (numerator + shift) * per_part + 0.5, slope: parts * dy * per_part }
    }

    #[inline(always)]
    fn row(&self, step: f64) -> i32 {
        nearest(self.slope * step + self.start)
    }
}

impl Spans {
    /// Columns with a span, some of which may be empty.
    #[inline(always)]
    #[must_use]
    pub fn columns(&self) -> Range<usize> {
        self.first..self.first + self.rows.len()
    }

    /// Whether a pixel is covered. Only for pixels inside the image that was scanned.
    #[inline(always)]
    #[must_use]
    pub fn covers(&self, x: i32, y: i32) -> bool {
        let column = (x as usize).wrapping_sub(self.first);
        self.rows.get(column).is_some_and(|rows| rows[0] <= y && y < rows[1])
    }

    /// Takes the spans of a convex polygon whose corners run counter-clockwise as seen (y down), in parts of a pixel, within an image of `width` columns.
    ///
    /// Edges that go to the left are upper ones. Rounding may turn a tiny edge the wrong way: the least of upper and the largest of lower rows are taken, so that it changes nothing.
    #[inline(always)]
    pub(crate) fn scan(&mut self, corners: &[[i32; 2]], width: usize) {
        let width = width as i32;
        let (mut first, mut end) = (width, 0);
        for corner in corners {
            let column = column_from(corner[0], width);
            first = first.min(column);
            end = end.max(column);
        }
        self.rows.clear();
        self.first = first as usize;
        let Some(mut before) = corners.last().copied() else { return };
        self.rows.resize((end - first) as usize, [i32::MAX, i32::MIN]);
        let mut column_before = column_from(before[0], width);
        for &corner in corners {
            let column = column_from(corner[0], width);
            if column < column_before {
                let edge = Edge::new(corner, before, corner[1] >= before[1], column, true);
                let mut step = 0.0;
                for rows in &mut self.rows[(column - first) as usize..(column_before - first) as usize] {
                    rows[0] = rows[0].min(edge.row(step));
                    step += 1.0;
                }
            } else if column > column_before {
                let edge = Edge::new(before, corner, corner[1] > before[1], column_before, false);
                let mut step = 0.0;
                for rows in &mut self.rows[(column_before - first) as usize..(column - first) as usize] {
                    rows[1] = rows[1].max(edge.row(step));
                    step += 1.0;
                }
            }
            (before, column_before) = (corner, column);
        }
    }

    /// Sets the pixels of the spans.
    #[inline(always)]
    pub(crate) fn draw(&self, image: &mut BitImage) {
        for (x, [top, bottom]) in (self.first..).zip(&self.rows) {
            image.fill(x, (*top).max(0) as usize..(*bottom).max(0) as usize);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PARTS: i64 = super::PARTS as i64;

    /// Sets the pixels that a convex polygon covers; corners in order, pixels, either way round. Polygons with a corner that is not finite cover nothing.
    fn fill_convex(image: &mut BitImage, corners: &[[f64; 2]], spans: &mut Spans) {
        if corners.len() < 3 || !corners.iter().flatten().all(|x| x.is_finite()) {
            return;
        }
        let rounded = |corner: &[f64; 2]| corner.map(|x| nearest(x.clamp(-FURTHEST, FURTHEST) * PARTS as f64));
        let mut corners: Vec<[i32; 2]> = corners.iter().map(rounded).collect();
        let mut doubled_area = 0;
        let mut before = corners[corners.len() - 1];
        for corner in &corners {
            let [[ax, ay], [bx, by]] = [before, *corner].map(|c| c.map(i64::from));
            doubled_area += ax * by - ay * bx;
            before = *corner;
        }
        if doubled_area > 0 {
            corners.reverse();
        }
        spans.scan(&corners, image.width());
        spans.draw(image);
    }

    /// The rule itself: on the inner side of every edge, or on it where it is a left or a top one. Corners in multiples of 1/256 pixel, clockwise as seen.
    fn covers(corners: &[[i64; 2]], x: i64, y: i64) -> bool {
        let centre = [PARTS * x + PARTS / 2, PARTS * y + PARTS / 2];
        (0..corners.len()).all(|i| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % corners.len()]);
            let side = (bx - ax) * (centre[1] - ay) - (by - ay) * (centre[0] - ax);
            let left_or_top = by < ay || by == ay && bx > ax;
            side > 0 || side == 0 && (left_or_top || (ax, ay) == (bx, by))
        })
    }

    /// Corners of the hull, clockwise as seen (y down), without those on a side.
    fn hull(mut points: Vec<[i64; 2]>) -> Vec<[i64; 2]> {
        points.sort_unstable();
        points.dedup();
        let turn =
            |a: [i64; 2], b: [i64; 2], c: [i64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let half = |points: &mut dyn Iterator<Item = [i64; 2]>| {
            let mut chain: Vec<[i64; 2]> = vec![];
            for p in points {
                while chain.len() > 1 && turn(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0 {
                    chain.pop();
                }
                chain.push(p);
            }
            chain.pop();
            chain
        };
        let mut all = half(&mut points.iter().copied());
        all.extend(half(&mut points.iter().rev().copied()));
        all
    }

    fn check(corners: &[[i64; 2]], width: usize, height: usize) -> Result<(), TestCaseError> {
        let pixels: Vec<[f64; 2]> = corners.iter().map(|c| c.map(|x| x as f64 / PARTS as f64)).collect();
        let backwards: Vec<[f64; 2]> = pixels.iter().rev().copied().collect();
        let mut spans = Spans::default();
        let [mut image, mut other] = [BitImage::new(width, height), BitImage::new(width, height)];
        fill_convex(&mut image, &pixels, &mut spans);
        fill_convex(&mut other, &backwards, &mut spans);
        prop_assert_eq!(&image, &other);
        for y in 0..height {
            for x in 0..width {
                prop_assert_eq!(image.get(x, y), covers(corners, x as i64, y as i64), "{} {} of {:?}", x, y, corners);
            }
        }
        Ok(())
    }

    /// In the image or somewhat beside it; on centres and edges of pixels; far outside.
    fn coordinate(pixels: i64) -> BoxedStrategy<i64> {
        prop_oneof![
            4 => -PARTS * 10..PARTS * (pixels + 10),
            3 => (-20..2 * pixels + 20).prop_map(|half| PARTS / 2 * half),
            1 => -90_000..90_000i64,
        ]
        .boxed()
    }

    proptest! {
        /// Corners anywhere, many on centres and edges of pixels, some far outside.
        #[test]
        fn polygons_cover_what_the_rule_says(
            points in prop::collection::vec([coordinate(70), coordinate(30)], 3..12),
        ) {
            let corners = hull(points);
            prop_assume!(corners.len() > 2);
            check(&corners, 70, 30)?;
        }

        /// Of two halves of a polygon every pixel is in exactly one.
        #[test]
        fn halves_share_no_pixel(points in prop::collection::vec([0..17_920i64, 0..7680i64], 4..10), cut in any::<prop::sample::Index>()) {
            let corners = hull(points);
            prop_assume!(corners.len() > 3);
            let cut = 2 + cut.index(corners.len() - 3);
            let pixels: Vec<[f64; 2]> = corners.iter().map(|c| c.map(|x| x as f64 / PARTS as f64)).collect();
            let mut spans = Spans::default();
            let drawn = |corners: &[[f64; 2]], spans: &mut Spans| {
                let mut image = BitImage::new(70, 30);
                fill_convex(&mut image, corners, spans);
                image
            };
            let whole = drawn(&pixels, &mut spans);
            let (one, two) = (drawn(&pixels[..=cut], &mut spans), drawn(&[&pixels[cut..], &pixels[..1]].concat(), &mut spans));
            let shared = crate::silhouettes::bit_image::overlap(&one, &two, 0..70);
            prop_assert_eq!((shared.both, shared.first_only + shared.second_only), (0, whole.count()));
        }
    }

    #[test]
    fn what_is_no_polygon_covers_nothing() {
        let (mut image, mut spans) = (BitImage::new(20, 20), Spans::default());
        for corners in [
            vec![],
            vec![[1.0, 1.0], [9.0, 9.0]],
            vec![[1.0, 1.0], [9.0, 9.0], [f64::NAN, 3.0]],
            vec![[1.0, 1.0], [9.0, 9.0], [f64::INFINITY, 3.0]],
            vec![[5.0, 5.0]; 4],
            vec![[-9.0, -9.0], [-1.0, -9.0], [-4.0, -1.0]],
        ] {
            fill_convex(&mut image, &corners, &mut spans);
            assert_eq!(image.count(), 0, "{corners:?}");
        }
        fill_convex(&mut image, &[[-1e300, -1e300], [1e300, -1e300], [1e300, 1e300], [-1e300, 1e300]], &mut spans);
        assert_eq!(image.count(), 400);
    }
}
