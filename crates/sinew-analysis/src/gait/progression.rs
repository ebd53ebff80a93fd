//! The direction in which a person walks, frame by frame, from the way of the pelvis.
//!
//! ```text
//! u(t) = d / |d|,   d = p(t + T/2) − p(t − T/2) on the ground
//! ```
//!
//! T is a second, about a stride, and longer for whoever walks slowly: until the pelvis has gone [`LEAST_WAY_M`], at most [`LONGEST_S`]. It sways aside with every step, more so on a beam, and a short way would point where it sways.
//! At the ends of a recording the interval is cut. Where the pelvis moves more slowly than [`LEAST_SPEED`] over a second nobody walks, and there is no direction. A turn is followed, since the interval moves along.

use super::walk::interpolated;

/// Interval in which the pelvis shows a direction, and whether the person walks, seconds.
const INTERVAL_S: f64 = 1.0;

/// The longest such interval, and the steps in which it becomes longer.
const LONGEST_S: f64 = 3.0;
const LONGER_S: f64 = 0.5;

/// Way that shows a direction, metres.
const LEAST_WAY_M: f64 = 0.8;

/// Speed of the pelvis below which a person does not walk, metres a second.
const LEAST_SPEED: f64 = 0.2;

/// Unit vector on the ground in each frame; `None` where the person does not walk.
pub(super) fn directions(times_s: &[f64], pelvis: &[[f64; 3]]) -> Vec<Option<[f64; 2]>> {
    let axes = [0, 1].map(|axis: usize| pelvis.iter().map(|p| p[axis]).collect::<Vec<f64>>());
    let [Some(first), Some(last)] = [times_s.first(), times_s.last()] else { return vec![] };
    let way = |time: f64, interval_s: f64| {
        let ends = [time - 0.5 * interval_s, time + 0.5 * interval_s].map(|t| t.clamp(*first, *last));
        let way = axes.each_ref().map(|x| interpolated(times_s, x, ends[1]) - interpolated(times_s, x, ends[0]));
        (way, way[0].hypot(way[1]), ends[1] - ends[0])
    };
    let direction = |time: &f64| {
        let (mut ahead, mut length, duration_s) = way(*time, INTERVAL_S);
        let walks = length > LEAST_SPEED * duration_s;
        let mut interval_s = INTERVAL_S;
        while walks && length < LEAST_WAY_M && interval_s < LONGEST_S {
            interval_s += LONGER_S;
            (ahead, length, _) = way(*time, interval_s);
        }
        (walks && length > 0.0).then(|| ahead.map(|x| x / length))
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
        // Slow steps along a beam, with a sway of 15 cm.
        let times: Vec<f64> = (0..120).map(|k| f64::from(k) / 30.0).collect();
        let sway = |t: f64| 0.15 * (3.0 * t).sin();
        let pelvis: Vec<[f64; 3]> = times.iter().map(|t| [0.4 * t, sway(*t), 1.0]).collect();
        let found = directions(&times, &pelvis);
        assert!(found[40..80].iter().all(|u| u.unwrap()[0] > 0.9), "{found:?}");
        assert!(directions(&[], &[]).is_empty() && directions(&[0.0], &[[0.0; 3]]) == [None]);
    }
}
