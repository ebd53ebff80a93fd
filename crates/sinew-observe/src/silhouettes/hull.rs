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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every point is on the inner side of every side, corners are points and turn right, and the order of the points does not matter. Places are multiples of ¼, so that areas are exact.
        #[test]
        fn a_hull_is_convex_and_holds_its_points(places in prop::collection::vec([-40..40i32, -40..40i32], 1..30)) {
            let points: Vec<[f64; 2]> = places.iter().map(|p| p.map(|x| 0.25 * f64::from(x))).collect();
            let (mut hull, mut other) = (vec![], vec![]);
            convex_hull(&mut points.clone(), &mut hull);
            convex_hull(&mut points.iter().rev().copied().collect::<Vec<_>>(), &mut other);
            prop_assert_eq!(&hull, &other);
            prop_assert!(hull.iter().all(|corner| points.contains(corner)));
            if hull.len() < 3 {
                let line = points.iter().all(|p| turn(points[0], hull.last().copied().unwrap_or(points[0]), *p) == 0.0);
                prop_assert!(line || hull.is_empty());
                return Ok(());
            }
            for i in 0..hull.len() {
                let [a, b, c] = [i, i + 1, i + 2].map(|k| hull[k % hull.len()]);
                prop_assert!(turn(a, b, c) > 0.0);
                prop_assert!(points.iter().all(|p| turn(a, b, *p) >= 0.0));
            }
        }
    }

    #[test]
    fn few_points_and_none() {
        let hull = |mut points: Vec<[f64; 2]>| {
            let mut hull = vec![[9.0; 2]];
            convex_hull(&mut points, &mut hull);
            hull
        };
        assert!(hull(vec![]).is_empty() && hull(vec![[1.0, 2.0]]).is_empty() && hull(vec![[1.0, 2.0]; 3]).is_empty());
        assert_eq!(hull(vec![[3.0, 1.0], [1.0, 2.0]]), [[1.0, 2.0], [3.0, 1.0]]);
        assert!(hull(vec![[0.0, 0.0], [1.0, f64::NAN], [1.0, 0.0]]).is_empty());
        let square = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 1.0]];
        assert_eq!(hull(square), [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
    }
}
