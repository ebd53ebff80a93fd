//! Heel strikes and toe offs from where heels and toes are ahead of the pelvis and behind it.
//!
//! Zeni, Richards & Higginson, Gait & Posture 27 (2008) 710, the coordinate-based method. With u the direction of walking, p the pelvis (the middle of the hips),
//!
//! ```text
//! a(t) = (heel − p)·u    a heel strikes where a is greatest, once a step
//! b(t) = (toe − p)·u     a toe leaves where b is least
//! ```
//!
//! 1. Slopes of a and b at the frames are of local polynomials ([`super::local_polynomial`]); between two frames where the slope changes its sign an extremum lies, found by bisection.
//! 2. An extremum counts if the series rises to it and falls from it by [`LEAST_SHARE`] of its range and [`LEAST_SWING_M`], between it and the extrema of the other kind beside it.
//! 3. Its time in draw i is, to the first order, `t − a'⁽ⁱ⁾(t) / a''(t)`, where a'⁽ⁱ⁾ is the slope of the draw less the mean, with the weights of the mean's fit. The extremum of a draw's own path would be one of its noise.
//!
//! Limits: who walks backwards, or brings the toes down first, has events of other meaning. These are instants of the motion; force plates give others, by a frame or two (there, table 1).

use super::local_polynomial::LocalFit;
use super::progression::directions;
use super::walk::{Path3, Walk};

/// Half the width of the window of the local polynomials, seconds, and its least number of frames.
const HALF_WIDTH_S: f64 = 0.15;
const LEAST_HALF_WIDTH_FRAMES: f64 = 3.01;

/// Least rise and fall beside an extremum: a share of the range of the series, and metres.
const LEAST_SHARE: f64 = 0.35;
const LEAST_SWING_M: f64 = 0.1;

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum GaitEventKind {
    /// A foot meets the ground.
    HeelStrike,
    /// It leaves it.
    ToeOff,
}

impl GaitEventKind {
    /// Name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::HeelStrike => "heel_strike",
            Self::ToeOff => "toe_off",
        }
    }

    /// What its time is the time of, as tables say it.
    #[must_use]
    pub const fn definition(self) -> &'static str {
        match self {
            Self::HeelStrike => "point farthest ahead of the pelvis (not contact)",
            Self::ToeOff => "point farthest behind the pelvis (not contact)",
        }
    }
}

/// An event of a foot.
#[derive(Clone, Debug, PartialEq)]
pub struct GaitEvent {
    /// 0: left, 1: right.
    pub side: usize,
    /// What happens.
    pub kind: GaitEventKind,
    /// Point that shows it.
    pub point: String,
    /// Time of the mean, seconds.
    pub time_s: f64,
    /// Time in each draw, seconds; none without draws.
    pub draws_s: Vec<f64>,
}

/// Half the width of the window at a rate.
pub(super) fn half_width_s(times_s: &[f64]) -> f64 {
    let count = times_s.len().max(2) - 1;
    let step = times_s.first().zip(times_s.last()).map_or(0.0, |(first, last)| (last - first) / count as f64);
    HALF_WIDTH_S.max(LEAST_HALF_WIDTH_FRAMES * step)
}

/// All events of both feet, in the order of time.
pub(super) fn events(walk: &Walk) -> Vec<GaitEvent> {
    let directions = directions(&walk.times_s, &walk.pelvis.mean);
    let mut found = vec![];
    for (side, foot) in walk.feet.iter().enumerate() {
        let ends = [(GaitEventKind::HeelStrike, &foot.heel, 1.0), (GaitEventKind::ToeOff, &foot.toe, -1.0)];
        for (kind, (point, path), sign) in ends {
            let ahead = |point: &[f64; 3], pelvis: &[f64; 3], frame: usize| {
                let u = directions[frame].unwrap_or([f64::NAN; 2]);
                sign * (0..2).map(|axis| (point[axis] - pelvis[axis]) * u[axis]).sum::<f64>()
            };
            let series = |path: &[[f64; 3]], pelvis: &[[f64; 3]]| -> Vec<f64> {
                path.iter()
                    .zip(pelvis)
                    .enumerate()
                    .map(|(frame, (point, pelvis))| ahead(point, pelvis, frame))
                    .collect()
            };
            let mean = series(&path.mean, &walk.pelvis.mean);
            let draws: Vec<Vec<f64>> = drawn(path, &walk.pelvis).map(|(path, pelvis)| series(path, pelvis)).collect();
            for time_s in peaks(&walk.times_s, &mean) {
                let draws_s = times_in_draws(&walk.times_s, time_s, &mean, &draws);
                found.push(GaitEvent { side, kind, point: point.clone(), time_s, draws_s });
            }
        }
    }
    found.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then(a.side.cmp(&b.side)));
    found
}

fn drawn<'a>(path: &'a Path3, pelvis: &'a Path3) -> impl Iterator<Item = (&'a [[f64; 3]], &'a [[f64; 3]])> {
    path.draws.iter().zip(&pelvis.draws).map(|(path, pelvis)| (&path[..], &pelvis[..]))
}

/// Times of the maxima of a series, which is NaN where nobody walks.
fn peaks(times_s: &[f64], series: &[f64]) -> Vec<f64> {
    let mut sorted: Vec<f64> = series.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    let least = LEAST_SWING_M.max(LEAST_SHARE * (at(0.95) - at(0.05)));
    pieces(times_s, series).iter().flat_map(|extrema| swings(extrema, least)).collect()
}

/// Time and value of an extremum, or of an end of a piece.
type Turn = (f64, f64);

/// The pieces of a series in which somebody walks: their extrema in the order of time, between their two ends.
fn pieces(times_s: &[f64], series: &[f64]) -> Vec<Vec<Turn>> {
    let half_width_s = half_width_s(times_s);
    let fit = |t: f64| LocalFit::at(times_s, t, half_width_s);
    let slope = |t: f64| fit(t).map(|fit| fit.slope(|frame| series[frame])).filter(|x| x.is_finite());
    let turn = |t: f64| (t, fit(t).map_or(f64::NAN, |fit| fit.value(|frame| series[frame])));
    let slopes: Vec<Option<f64>> = times_s.iter().map(|t| slope(*t)).collect();
    let mut found: Vec<Vec<Turn>> = vec![];
    for frame in 0..times_s.len() {
        let Some(after) = slopes[frame] else { continue };
        let before = frame.checked_sub(1).and_then(|last| slopes[last]);
        match (before, found.last_mut()) {
            (Some(before), Some(piece)) if (before > 0.0) != (after > 0.0) => {
                piece.push(turn(root(&slope, [times_s[frame - 1], times_s[frame]], before > 0.0)));
            }
            (Some(_), Some(_)) => {}
            _ => found.push(vec![turn(times_s[frame])]),
        }
        if let (None, Some(piece)) = (slopes.get(frame + 1).copied().flatten(), found.last_mut()) {
            piece.push(turn(times_s[frame]));
        }
    }
    found
}

/// Where a slope that is positive or not at the first of two times changes its sign.
fn root(slope: &dyn Fn(f64) -> Option<f64>, [mut low, mut high]: [f64; 2], is_positive: bool) -> f64 {
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        match slope(middle) {
            Some(at) if (at > 0.0) == is_positive => low = middle,
            _ => high = middle,
        }
    }
    low
}

/// Times of maxima between which a piece falls and rises by a least amount; its ends are none.
fn swings(piece: &[Turn], least: f64) -> Vec<f64> {
    let mut found = vec![];
    // The lowest place since the last peak, and the highest one since that is high enough above it.
    let (mut low, mut high): (f64, Option<Turn>) = (f64::INFINITY, None);
    for &(time, value) in piece {
        match high {
            Some((peak_time, peak)) if value < peak - least => {
                found.push(peak_time);
                (low, high) = (value, None);
            }
            Some((_, peak)) if value > peak => high = Some((time, value)),
            Some(_) => {}
            None if value > low + least => high = Some((time, value)),
            None => low = low.min(value),
        }
    }
    found
}

/// Time of an extremum in each draw, to the first order about the mean.
fn times_in_draws(times_s: &[f64], time_s: f64, mean: &[f64], draws: &[Vec<f64>]) -> Vec<f64> {
    let Some(fit) = LocalFit::at(times_s, time_s, half_width_s(times_s)) else { return vec![] };
    let curvature = fit.curvature(|frame| mean[frame]);
    draws.iter().map(|draw| time_s - fit.slope(|frame| draw[frame] - mean[frame]) / curvature).collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Somebody whose heels swing as sines about a pelvis at constant speed: 0.3 m, a stride a second, the right foot half a stride after the left.
    pub(in super::super) fn sines(rate_hz: f64, heading: f64) -> Walk {
        let frames = (6.0 * rate_hz) as usize;
        let times_s: Vec<f64> = (0..frames).map(|k| k as f64 / rate_hz).collect();
        let (sin, cos) = heading.sin_cos();
        let place = |ahead: f64, aside: f64, up: f64| [cos * ahead - sin * aside, sin * ahead + cos * aside, up];
        let path =
            |at: &dyn Fn(f64) -> [f64; 3]| Path3 { mean: times_s.iter().map(|t| at(*t)).collect(), draws: vec![] };
        let speed = 1.2;
        let foot = |side: usize| {
            let (aside, late) = ([0.1, -0.1][side], [0.0, 0.5][side]);
            let swing = move |t: f64, phase: f64| speed * t + 0.3 * (TAU * (t - 0.25 - late - phase)).cos();
            Foot {
                heel: ("Heel".into(), path(&|t| place(swing(t, 0.0), aside, 0.0))),
                toe: ("BigToe".into(), path(&|t| place(swing(t, 0.1) + 0.2, aside, 0.0))),
            }
        };
        Walk {
            numbers: (0..frames).map(|k| k as f64).collect(),
            pelvis: path(&|t| place(speed * t, 0.0, 1.0)),
            feet: [foot(0), foot(1)],
            ankles_only: false,
            apart_s: 0.0,
            times_s,
        }
    }

    use super::super::walk::Foot;

    fn times(found: &[GaitEvent], side: usize, kind: GaitEventKind) -> Vec<f64> {
        found.iter().filter(|event| event.side == side && event.kind == kind).map(|event| event.time_s).collect()
    }

    #[test]
    fn sines_have_their_events_where_they_are() {
        for (rate, heading) in [(30.0, 0.0), (60.0, 2.0), (100.0, -1.0), (25.0, 4.0)] {
            let found = events(&sines(rate, heading));
            for side in 0..2 {
                for (kind, first) in [(GaitEventKind::HeelStrike, 0.25), (GaitEventKind::ToeOff, 0.85)] {
                    let own = times(&found, side, kind);
                    assert!(own.len() >= 4, "{rate} {side} {kind:?}: {own:?}");
                    for time in own {
                        let off = (time - first - 0.5 * side as f64).rem_euclid(1.0);
                        assert!(off.min(1.0 - off) < 5e-4, "{rate} {side} {kind:?}: {time}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_turn_does_not_move_events() {
        let straight = sines(50.0, 0.0);
        let mut walk = straight.clone();
        // The straight way is wound onto a circle of 3 m.
        let wind = |place: &[f64; 3], pelvis: &[f64; 3]| {
            let (sin, cos) = (pelvis[0] / 3.0).sin_cos();
            let (ahead, out) = (place[0] - pelvis[0], 3.0 - place[1]);
            [out * cos - ahead * sin, out * sin + ahead * cos, place[2]]
        };
        let pelvis = &straight.pelvis.mean;
        let wound = |path: &Path3| {
            let mean = path.mean.iter().zip(pelvis).map(|(place, pelvis)| wind(place, pelvis)).collect();
            Path3 { mean, draws: vec![] }
        };
        walk.pelvis = wound(&straight.pelvis);
        for (foot, own) in walk.feet.iter_mut().zip(&straight.feet) {
            (foot.heel.1, foot.toe.1) = (wound(&own.heel.1), wound(&own.toe.1));
        }
        let inner = |time: f64| (0.6..5.4).contains(&time);
        let [a, b] = [events(&straight), events(&walk)]
            .map(|found| found.into_iter().map(|event| event.time_s).filter(|time| inner(*time)).collect::<Vec<_>>());
        assert!(a.len() > 15 && a.len() == b.len(), "{} {}", a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-6), "{a:?} {b:?}");
    }

    #[test]
    fn standing_and_shifting_weight_are_no_events() {
        let mut walk = sines(30.0, 0.0);
        let still = walk.pelvis.mean[0];
        walk.pelvis.mean.iter_mut().for_each(|p| *p = still);
        assert!(events(&walk).is_empty());
        let mut walk = sines(30.0, 0.0);
        walk.feet.iter_mut().for_each(|foot| {
            foot.heel.1 = walk.pelvis.clone();
            foot.toe.1 = walk.pelvis.clone();
        });
        assert!(events(&walk).is_empty());
        assert!(events(&Walk::default()).is_empty());
    }

    #[test]
    fn a_foot_that_is_moved_against_time_moves_its_events() {
        let mut walk = sines(60.0, 0.5);
        let early = sines(60.0, 0.5);
        // Draws of which one is the mean, others are 10 ms late and early.
        let shifted = |late_s: f64| {
            let mut other = sines(60.0, 0.5);
            let ahead = |t: f64| 1.2 * t + 0.3 * (TAU * (t - 0.25 - late_s)).cos();
            let (sin, cos) = 0.5_f64.sin_cos();
            for (place, t) in other.feet[0].heel.1.mean.iter_mut().zip(&early.times_s) {
                *place = [cos * ahead(*t) - sin * 0.1, sin * ahead(*t) + cos * 0.1, 0.0];
            }
            other.feet[0].heel.1.mean.clone()
        };
        walk.feet[0].heel.1.draws = [0.0, 0.01, -0.01].map(shifted).to_vec();
        walk.pelvis.draws = vec![walk.pelvis.mean.clone(); 3];
        for event in events(&walk).iter().filter(|event| event.point == "Heel" && event.side == 0) {
            let moved: Vec<f64> = event.draws_s.iter().map(|t| t - event.time_s).collect();
            let expected = [0.0, 0.01, -0.01];
            // The fit flattens the slope and the curvature of a sine of a second by shares that differ by 4 %.
            assert!(moved.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-4), "{moved:?}");
        }
    }

    #[test]
    fn small_wiggles_are_no_steps() {
        let extrema =
            [(0.0, 0.0), (1.0, 0.6), (2.0, 0.55), (3.0, 0.62), (4.0, -0.1), (5.0, 0.0), (6.0, -0.1), (7.0, 0.5)];
        assert_eq!(swings(&extrema, 0.2), [3.0]);
        assert!(swings(&extrema, 1.0).is_empty() && swings(&[], 0.1).is_empty());
    }
}
