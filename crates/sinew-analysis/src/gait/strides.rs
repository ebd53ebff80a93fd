//! Strides from events and from where the feet stand: lengths, widths, times, shares of the cycle.
//!
//! A stride of a side begins with a heel strike of that foot at A and ends with its next at C; the other foot strikes between them, at B. A foot's *place* is the mean of its heel from [`FLAT`] of a stride after the strike, in which it lies flat.
//! (At the strike itself, where the heel is farthest ahead of the pelvis, it still moves as fast as the pelvis: 10 ms would be 12 mm.)
//!
//! ```text
//! stride length |C − A|        step length (C − B)·e,  e = (C − A)/|C − A|        step width |(B − A) × e|
//! stride time t_C − t_A        step time t_C − t_B        cadence 120 / (t_C − t_A)        speed |C − A| / (t_C − t_A)
//! stance (t_off − t_A)/(t_C − t_A)        swing 1 − stance
//! double support ((t_off of the other − t_A) + (t_off − t_B))/(t_C − t_A)
//! ```
//!
//! The place in draw i is that mean plus the draw's mean distance from it in m frames, evenly over the n that are flat. Errors that persist with the time constant τ are independent after 2 τ, so that m is their time over 2 τ, from 1 to n: all frames in a smoothed run whose errors do not persist, the middle one in a filtered run, whose draws do not say how errors of neighbouring frames belong together.
//!
//! Lengths and width are on the ground and relative to the stride's own line, so that they hold on a curve: Huxham, Gong, Baker, Morris & Iansek, Gait & Posture 23 (2006) 159. Each is worked out from the means, and from the places and times of every draw.

use super::events::{GaitEvent, GaitEventKind};
use super::varied::Varied;
use super::walk::{Path3, Walk};
use sinew_core::estimators::median;

/// Part of a stride after a heel strike in which the foot lies flat: from the end of loading to before the heel rises (Perry & Burnfield, *Gait Analysis*, 2nd ed. 2010, chapter 3).
const FLAT: [f64; 2] = [0.12, 0.30];

/// A stride longer than this many times the median is a pause.
const LONGEST: f64 = 2.0;

/// Parameters of a stride: names as in tables.
pub const PARAMETERS: [&str; 10] = [
    "step_length_m",
    "stride_length_m",
    "step_width_m",
    "step_time_s",
    "stride_time_s",
    "cadence_per_min",
    "speed_m_per_s",
    "stance_share",
    "swing_share",
    "double_support_share",
];

/// A stride.
#[derive(Clone, Debug, PartialEq)]
pub struct Stride {
    /// Side of the foot that begins and ends it; 0: left, 1: right.
    pub side: usize,
    /// Time of the heel strike that begins it, seconds.
    pub start_s: f64,
    /// Time of the next one of the same foot.
    pub end_s: f64,
    /// Time at which this foot leaves the ground.
    pub toe_off_s: Option<f64>,
    /// One for each of [`PARAMETERS`]; `None` where the recording does not show it.
    pub parameters: [Option<Varied>; PARAMETERS.len()],
}

/// A heel strike with where the foot stands after it.
struct Contact<'a> {
    event: &'a GaitEvent,
    place: Option<[Varied; 2]>,
}

/// All strides of both sides, in the order of time.
pub(super) fn strides(walk: &Walk, events: &[GaitEvent]) -> Vec<Stride> {
    let own = |side: usize, kind| events.iter().filter(move |event| event.side == side && event.kind == kind);
    let strikes = [0, 1].map(|side| own(side, GaitEventKind::HeelStrike).collect::<Vec<_>>());
    let offs = [0, 1].map(|side| own(side, GaitEventKind::ToeOff).collect::<Vec<_>>());
    let between = |pair: &[&GaitEvent]| pair[1].time_s - pair[0].time_s;
    let mut times: Vec<f64> = strikes.iter().flat_map(|own| own.windows(2).map(between)).collect();
    if times.is_empty() {
        return vec![];
    }
    let usual_s = median(&mut times);
    let contacts = [0, 1].map(|side: usize| {
        let place = |event: &GaitEvent| place(walk, &walk.feet[side].heel.1, event.time_s, usual_s);
        strikes[side].iter().map(|event| Contact { event, place: place(event) }).collect::<Vec<_>>()
    });
    let mut found = vec![];
    for side in 0..2 {
        for pair in contacts[side].windows(2) {
            let (start_s, end_s) = (pair[0].event.time_s, pair[1].event.time_s);
            if end_s - start_s > LONGEST * usual_s {
                continue;
            }
            let is_inside = |event: &GaitEvent| event.time_s > start_s && event.time_s < end_s;
            let other = only(contacts[1 - side].iter().filter(|contact| is_inside(contact.event)));
            let off = only(offs[side].iter().copied().filter(|event| is_inside(event)));
            let before = |event: &&GaitEvent| other.is_some_and(|other| event.time_s < other.event.time_s);
            let other_off = only(offs[1 - side].iter().copied().filter(|event| is_inside(event)).filter(before));
            let parameters = parameters(walk.draws(), [&pair[0], &pair[1]], other, [off, other_off]);
            found.push(Stride { side, start_s, end_s, toe_off_s: off.map(|event| event.time_s), parameters });
        }
    }
    found.sort_by(|a, b| a.start_s.total_cmp(&b.start_s));
    found
}

/// The one there is, if there is just one.
fn only<T>(mut all: impl Iterator<Item = T>) -> Option<T> {
    let first = all.next()?;
    all.next().is_none().then_some(first)
}

/// Mean of the heel while the foot lies flat, on the ground; `None` where the recording ends before.
fn place(walk: &Walk, heel: &Path3, strike_s: f64, stride_s: f64) -> Option<[Varied; 2]> {
    let [from, to] = FLAT.map(|share| strike_s + share * stride_s);
    let first = walk.times_s.partition_point(|t| *t < from);
    let end = walk.times_s.partition_point(|t| *t <= to);
    if first >= end || walk.times_s.last().is_none_or(|last| *last < to) {
        return None;
    }
    let mean = |path: &[[f64; 3]], axis: usize| {
        path[first..end].iter().map(|place| place[axis]).sum::<f64>() / (end - first) as f64
    };
    let count = end - first;
    let independent = ((to - from) / walk.apart_s).clamp(1.0, count as f64) as usize;
    let few: Vec<usize> = (0..independent).map(|k| first + (2 * k + 1) * count / (2 * independent)).collect();
    let away = |path: &[[f64; 3]], axis: usize| {
        few.iter().map(|&frame| path[frame][axis] - heel.mean[frame][axis]).sum::<f64>() / independent as f64
    };
    let axis = |axis: usize| {
        let away = |draw: usize| away(&heel.draws[draw], axis);
        Varied::new(heel.draws.len(), |draw| mean(&heel.mean, axis) + draw.map_or(0.0, away))
    };
    Some([axis(0), axis(1)])
}

/// What follows for a stride from its two contacts, the one of the other foot between them, and when both feet leave.
fn parameters(
    draws: usize,
    [start, end]: [&Contact<'_>; 2],
    other: Option<&Contact<'_>>,
    [off, other_off]: [Option<&GaitEvent>; 2],
) -> [Option<Varied>; PARAMETERS.len()] {
    let time = |event: &GaitEvent, draw: Option<usize>| match draw {
        None => event.time_s,
        Some(draw) => event.draws_s.get(draw).copied().unwrap_or(f64::NAN),
    };
    let at = |contact: &Contact<'_>, draw| time(contact.event, draw);
    let place =
        |contact: &Contact<'_>, draw| contact.place.as_ref().map_or([f64::NAN; 2], |[x, y]| [x.at(draw), y.at(draw)]);
    let way = |from: &Contact<'_>, to: &Contact<'_>, draw| {
        let (from, to) = (place(from, draw), place(to, draw));
        [to[0] - from[0], to[1] - from[1]]
    };
    let length = |draw| {
        let [x, y] = way(start, end, draw);
        x.hypot(y)
    };
    let stride_s = |draw| at(end, draw) - at(start, draw);
    let stance = |off: &GaitEvent, draw| (time(off, draw) - at(start, draw)) / stride_s(draw);
    let varied =
        |value: &dyn Fn(Option<usize>) -> f64| Some(Varied::new(draws, value)).filter(|varied| varied.mean.is_finite());
    let with_other =
        |value: &dyn Fn(&Contact<'_>, Option<usize>) -> f64| other.and_then(|other| varied(&|draw| value(other, draw)));
    [
        with_other(&|other, draw| {
            let (step, line) = (way(other, end, draw), way(start, end, draw));
            (step[0] * line[0] + step[1] * line[1]) / length(draw)
        }),
        varied(&length),
        with_other(&|other, draw| {
            let (step, line) = (way(start, other, draw), way(start, end, draw));
            (step[0] * line[1] - step[1] * line[0]).abs() / length(draw)
        }),
        with_other(&|other, draw| at(end, draw) - at(other, draw)),
        varied(&stride_s),
        varied(&|draw| 120.0 / stride_s(draw)),
        varied(&|draw| length(draw) / stride_s(draw)),
        off.and_then(|off| varied(&|draw| stance(off, draw))),
        off.and_then(|off| varied(&|draw| 1.0 - stance(off, draw))),
        off.zip(other_off).and_then(|(off, other_off)| {
            with_other(&|other, draw| stance(other_off, draw) + (time(off, draw) - at(other, draw)) / stride_s(draw))
        }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn event(side: usize, kind: GaitEventKind, time_s: f64) -> GaitEvent {
        GaitEvent { side, kind, point: "Heel".into(), time_s, draws_s: vec![time_s + 0.02, time_s - 0.02] }
    }

    /// A left foot that stands at 0 m, 1.2 m and 2.4 m and a right one at 0.5 m and 1.7 m, 0.2 m aside, turned by a heading.
    fn standing(heading: f64) -> Walk {
        let times_s: Vec<f64> = (0..300).map(|k| f64::from(k) / 100.0).collect();
        let (sin, cos) = heading.sin_cos();
        let foot = |first_s: f64, first_m: f64, aside: f64| {
            let at = |t: &f64| {
                let ahead = first_m + 1.2 * ((t - first_s).max(0.0)).floor();
                [cos * ahead - sin * aside, sin * ahead + cos * aside, 0.0]
            };
            let mean: Vec<[f64; 3]> = times_s.iter().map(at).collect();
            // Draws of which one sees everything a tenth longer.
            let longer = mean.iter().map(|place| place.map(|x| 1.1 * x)).collect();
            Path3 { draws: vec![mean.clone(), longer], mean }
        };
        let mut walk = Walk { pelvis: foot(0.0, 0.0, 0.0), times_s: times_s.clone(), ..Walk::default() };
        walk.feet[0].heel.1 = foot(0.1, 0.0, 0.0);
        walk.feet[1].heel.1 = foot(0.7, 0.5, -0.2);
        walk
    }

    #[test]
    fn a_known_walk_has_its_parameters_in_any_direction() {
        use GaitEventKind::{HeelStrike, ToeOff};
        for heading in [0.0, 1.0, -2.5] {
            let events = [
                event(0, HeelStrike, 0.1),
                event(1, ToeOff, 0.2),
                event(1, HeelStrike, 0.7),
                event(0, ToeOff, 0.75),
                event(0, HeelStrike, 1.1),
                event(1, ToeOff, 1.25),
                event(1, HeelStrike, 1.7),
                event(0, HeelStrike, 2.1),
            ];
            let found = strides(&standing(heading), &events);
            assert_eq!(found.iter().map(|stride| stride.side).collect::<Vec<_>>(), [0, 1, 0]);
            let left = &found[0];
            let expected = [0.7, 1.2, 0.2, 0.4, 1.0, 120.0, 1.2, 0.65, 0.35, 0.15];
            for ((name, found), expected) in PARAMETERS.iter().zip(&left.parameters).zip(expected) {
                let found = found.as_ref().unwrap();
                assert!((found.mean - expected).abs() < 1e-9, "{name}: {found:?} {expected}");
                let longer = if name.ends_with("_m") || name.starts_with("speed") { 1.1 } else { 1.0 };
                assert!((found.draws[0] - expected).abs() < 1e-9, "{name}: {found:?}");
                assert!((found.draws[1] - longer * expected).abs() < 1e-9, "{name}: {found:?}");
            }
            let right = &found[1];
            assert!((right.parameters[0].as_ref().unwrap().mean - 0.5).abs() < 1e-9);
            // The left foot leaves no more, and the right one not at all in the last stride.
            assert!(found[2].parameters[7].is_none() && found[2].parameters[9].is_none());
        }
    }

    #[test]
    fn errors_average_out_over_the_frames_in_which_they_are_independent() {
        let mut walk = standing(0.0);
        // Frame after frame the draws err by 1 cm to the other side.
        let mean = walk.feet[0].heel.1.mean.clone();
        let zigzag = |sign: f64| {
            let moved = |(frame, place): (usize, &[f64; 3])| {
                [place[0] + 0.01 * sign * if frame % 2 == 0 { 1.0 } else { -1.0 }, place[1], place[2]]
            };
            mean.iter().enumerate().map(moved).collect::<Vec<_>>()
        };
        walk.feet[0].heel.1.draws = vec![zigzag(1.0), zigzag(-1.0)];
        let mut spread = |apart_s: f64| {
            walk.apart_s = apart_s;
            let [x, _] = place(&walk, &walk.feet[0].heel.1, 1.005, 1.0).unwrap();
            (x.mean, (x.draws[0] - x.draws[1]).abs())
        };
        let (all, one) = (spread(0.0), spread(f64::INFINITY));
        assert!(all.0 == one.0 && all.1 < 1e-12 && (one.1 - 0.02).abs() < 1e-12, "{all:?} {one:?}");
        // Three frames, six apart: they err to one side.
        assert!((spread(0.05).1 - 0.02).abs() < 1e-12);
    }

    #[test]
    fn pauses_are_no_strides_and_what_is_not_shown_is_left_out() {
        use GaitEventKind::HeelStrike;
        let events = [0.1, 0.6, 1.1, 2.8].map(|time| event(0, HeelStrike, time));
        let found = strides(&standing(0.0), &events);
        assert_eq!(found.len(), 2);
        assert!(found.iter().all(|stride| stride.parameters[0].is_none() && stride.parameters[4].is_some()));
        assert!(strides(&standing(0.0), &events[..1]).is_empty() && strides(&Walk::default(), &[]).is_empty());
        // The recording ends before the foot lies flat.
        let late = [event(0, HeelStrike, 1.0), event(0, HeelStrike, 2.9)];
        let found = strides(&standing(0.0), &late);
        assert!(found[0].parameters[1].is_none() && found[0].parameters[4].is_some());
    }
}
