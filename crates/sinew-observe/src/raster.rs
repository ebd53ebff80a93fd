//! Convex polygons into [`BitImage`]s.
//!
//! Pixel (x, y) has its centre at (x + ½, y + ½); x goes right and y down. It is covered where its centre lies inside the polygon. A centre on an edge counts if the edge is a left or a top one, so that of two polygons which
//! share an edge exactly one has the pixel. Corners are first rounded to 1/256 pixel: everything after that is whole numbers and exact.
//!
//! Every edge that is not horizontal tells one end of the span of each row between its corners, by a division at its first row and additions after that (Bresenham 1965).

use crate::bit_image::BitImage;

/// Parts of a pixel that corners are rounded to.
const PARTS: i64 = 256;
/// Corners further from the image's origin than this many pixels are moved there: products stay within 64 bits.
const FURTHEST: f64 = 1_048_576.0;

/// The first column whose centre is at or right of an edge, row after row.
struct Edge {
    column: i64,
    rest: i64,
    step: i64,
    rest_step: i64,
    whole: i64,
}

impl Edge {
    /// From `top` down to `bottom`, at the row whose centre has the ordinate `y`.
    fn new(top: [i64; 2], bottom: [i64; 2], y: i64) -> Self {
        let [dx, dy] = [bottom[0] - top[0], bottom[1] - top[1]];
        // The centre of column c is at or right of the edge where c · whole ≥ place.
        let (whole, place) = (PARTS * dy, (top[0] - PARTS / 2) * dy + (y - top[1]) * dx);
        Self {
            column: place.div_euclid(whole),
            rest: place.rem_euclid(whole),
            step: (PARTS * dx).div_euclid(whole),
            rest_step: (PARTS * dx).rem_euclid(whole),
            whole,
        }
    }

    fn next(&mut self) -> i64 {
        let column = self.column + i64::from(self.rest > 0);
        self.column += self.step;
        self.rest += self.rest_step;
        if self.rest >= self.whole {
            self.rest -= self.whole;
            self.column += 1;
        }
        column
    }
}

/// The first row whose centre is at or below an ordinate.
const fn row_from(y: i64) -> i64 {
    (y + PARTS / 2 - 1).div_euclid(PARTS)
}

/// Columns of each row that some polygons cover; kept to be used again.
#[derive(Clone, Debug, Default)]
pub struct Spans {
    rows: Vec<[i64; 2]>,
}

/// Sets the pixels that a convex polygon covers; corners in order, pixels, either way round. Polygons with a corner that is not finite cover nothing.
pub fn fill_convex(image: &mut BitImage, corners: &[[f64; 2]], spans: &mut Spans) {
    if corners.len() < 3 || !corners.iter().flatten().all(|x| x.is_finite()) {
        return;
    }
    let rounded = |corner: &[f64; 2]| corner.map(|x| (x.clamp(-FURTHEST, FURTHEST) * PARTS as f64).round() as i64);
    let height = image.height() as i64;
    let rows = |from: i64, to: i64| [from, to].map(|y| row_from(y).clamp(0, height));
    let ordinates = || corners.iter().map(|corner| rounded(corner)[1]);
    let (Some(top), Some(bottom)) = (ordinates().min(), ordinates().max()) else { return };
    let [first, end] = rows(top, bottom);
    spans.rows.clear();
    spans.rows.resize((end - first) as usize, [i64::MAX, i64::MIN]);
    let mut before = rounded(&corners[corners.len() - 1]);
    for corner in corners {
        let corner = rounded(corner);
        let (upper, lower) = if before[1] < corner[1] { (before, corner) } else { (corner, before) };
        let [from, to] = rows(upper[1], lower[1]);
        if from < to {
            let mut edge = Edge::new(upper, lower, PARTS * from + PARTS / 2);
            for span in &mut spans.rows[(from - first) as usize..(to - first) as usize] {
                let column = edge.next();
                *span = [span[0].min(column), span[1].max(column)];
            }
        }
        before = corner;
    }
    for (y, [left, right]) in (first as usize..).zip(&spans.rows) {
        image.fill(y, (*left).max(0) as usize..(*right).max(0) as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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
            let shared = crate::bit_image::overlap(&one, &two, 0..30);
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
