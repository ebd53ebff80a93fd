//! Convex hulls of points in the image, by the monotone chain (Andrew 1979).

use std::cmp::Ordering;

/// The doubled area of the triangle a, b, c; positive where the way from a over b to c turns right as seen, y down.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Goes along sorted points and keeps the ones on one side of the hull, the last one left out.
fn chain(points: impl Iterator<Item = [f64; 2]>, hull: &mut Vec<[f64; 2]>) {
    let start = hull.len();
    for point in points {
        while hull.len() > start + 1 && turn(hull[hull.len() - 2], hull[hull.len() - 1], point) <= 0.0 {
            hull.pop();
        }
        hull.push(point);
    }
    hull.pop();
}

/// Corners of the smallest convex polygon around some points, clockwise as seen (y down), none of them on a side; the points are sorted on the way. Two points give both, and none is given where all are one or one is not
/// a number.
pub fn convex_hull(points: &mut [[f64; 2]], hull: &mut Vec<[f64; 2]>) {
    hull.clear();
    if points.iter().flatten().any(|x| x.is_nan()) {
        return;
    }
    points.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
    if points.first() == points.last() {
        return;
    }
    chain(points.iter().copied(), hull);
    chain(points.iter().rev().copied(), hull);
}
