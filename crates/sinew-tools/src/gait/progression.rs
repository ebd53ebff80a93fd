//! The direction in which a person walks, frame by frame, from the way of the pelvis.
//!
//! ```text
//! u(t) = d / |d|,   d = p(t + T/2) − p(t − T/2) on the ground,   T about a stride
//! ```
//!
//! At the ends of a recording the interval is cut. Where the pelvis moves more slowly than [`LEAST_SPEED`] nobody walks, and there is no direction. A turn is followed, since the interval moves along.

use super::walk::interpolated;

/// Interval in which the pelvis shows a direction, seconds.
const INTERVAL_S: f64 = 1.0;

/// Speed of the pelvis below which a person does not walk, metres a second.
pub(super) const LEAST_SPEED: f64 = 0.2;

/// Unit vector on the ground in each frame; `None` where the person does not walk.
pub(super) fn directions(times_s: &[f64], pelvis: &[[f64; 3]]) -> Vec<Option<[f64; 2]>> {
    let axes = [0, 1].map(|axis: usize| pelvis.iter().map(|p| p[axis]).collect::<Vec<f64>>());
    let [Some(first), Some(last)] = [times_s.first(), times_s.last()] else { return vec![] };
    let direction = |time: &f64| {
        let ends = [time - 0.5 * INTERVAL_S, time + 0.5 * INTERVAL_S].map(|t| t.clamp(*first, *last));
        let way = axes.each_ref().map(|x| interpolated(times_s, x, ends[1]) - interpolated(times_s, x, ends[0]));
        let length = way[0].hypot(way[1]);
        (length > LEAST_SPEED * (ends[1] - ends[0])).then(|| way.map(|x| x / length))
    };
    times_s.iter().map(direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_direction_follows_a_turn_and_is_none_in_standing() {
        let times: Vec<f64> = (0..200).map(|k| f64::from(k) / 50.0).collect();
        // On a circle of 3 m with 1 m/s, then standing.
        let turn = |t: f64| t.min(2.0) / 3.0;
        let pelvis: Vec<[f64; 3]> = times.iter().map(|t| [3.0 * turn(*t).cos(), 3.0 * turn(*t).sin(), 1.0]).collect();
        let found = directions(&times, &pelvis);
        for frame in [30, 50, 70] {
            let (u, angle) = (found[frame].unwrap(), turn(times[frame]));
            assert!((u[0] + angle.sin()).abs() < 1e-6 && (u[1] - angle.cos()).abs() < 1e-6, "{frame}: {u:?}");
        }
        assert!(found[130..].iter().all(Option::is_none) && found[0].is_some());
        assert!(directions(&[], &[]).is_empty() && directions(&[0.0], &[[0.0; 3]]) == [None]);
    }
}
