//! True gait of walkers, without the program's detector: from the generator's own phases, and from noise-free points.
//!
//! *Contacts* are where the load of a foot begins and ends in the generator. *Extrema* are the plain largest and smallest of a thousand points a second, of the noise-free heel and toe relative to the hips along the direction in which the walker is known to walk. Feet stand where their heel is at [`FLAT_PHASE`]. Of recorded motion ([`recorded`]) extrema are the plain ones among the frames, with a parabola through three of them.

use crate::support::outcome::Outcome;
use sinew_body::points::{Trajectories, points_of_states};
use sinew_simulate::walker::{DOUBLE_SUPPORT, Walker, phase, walker_states};

/// Points a second.
const RATE_HZ: f64 = 1000.0;
/// Phase after a heel strike at which the heel stands.
const FLAT_PHASE: f64 = 0.22;
/// Phases around a contact in which its extremum lies.
const AROUND: f64 = 0.2;

/// A true event.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrueEvent {
    /// 0: left, 1: right.
    pub(super) side: usize,
    pub(super) is_strike: bool,
    /// Time of the extremum, seconds.
    pub(super) extremum_s: f64,
    /// Time of the contact, seconds; that of the extremum where no contact is known.
    pub(super) contact_s: f64,
    /// Where the foot stands after a strike: aside and ahead, metres.
    pub(super) place: Option<[f64; 2]>,
}

/// All events of a walker, in the order of their contacts.
pub(super) fn events(walker: &Walker) -> Outcome<Vec<TrueEvent>> {
    let states = walker_states(walker, RATE_HZ);
    let points = points_of_states(&walker.body, &states);
    let column = |name: &str| points.index(name).ok_or_else(|| format!("the walker lacks {name}"));
    let hips = [column("LHip")?, column("RHip")?];
    let pelvis = |frame: usize| 0.5 * (points.frames[frame][hips[0]][1] + points.frames[frame][hips[1]][1]);
    let phases: Vec<f64> = (0..states.len()).map(|frame| phase(&walker.gait, frame as f64 / RATE_HZ)).collect();
    let first = |phase: f64| phases.iter().position(|own| *own >= phase).filter(|frame| *frame > 0);
    let mut found = vec![];
    for (side, [heel, toe], ahead) in [(0, ["LHeel", "LBigToe"], 0.5), (1, ["RHeel", "RBigToe"], 0.0)] {
        let (heel, toe) = (column(heel)?, column(toe)?);
        for (is_strike, point, after, sign) in [(true, heel, 0.0, 1.0), (false, toe, 0.5 + DOUBLE_SUPPORT, -1.0)] {
            for cycle in 0..1000 {
                let at = f64::from(cycle) + after - ahead;
                let Some(contact) = first(at) else { continue };
                let (from, to) = (first(at - AROUND), first(at + AROUND));
                let (Some(from), Some(to)) = (from, to) else { continue };
                let value = |frame: &usize| sign * (points.frames[*frame][point][1] - pelvis(*frame));
                let best = (from..to).max_by(|a, b| value(a).total_cmp(&value(b))).unwrap_or(contact);
                let is_inside = best > from && best + 1 < to;
                let stands = first(at + FLAT_PHASE).filter(|_| is_strike);
                let place = stands.map(|frame| [points.frames[frame][heel][0], points.frames[frame][heel][1]]);
                let [extremum_s, contact_s] = [best, contact].map(|frame| frame as f64 / RATE_HZ);
                if is_inside {
                    found.push(TrueEvent { side, is_strike, extremum_s, contact_s, place });
                }
            }
        }
    }
    found.sort_by(|a, b| a.contact_s.total_cmp(&b.contact_s));
    Ok(found)
}

/// Least distance between two extrema of a kind, seconds.
const APART_S: f64 = 0.3;

/// Events of a recorded motion that walks straight, by its ankles and big toes, in the order of time.
pub(super) fn recorded(points: &Trajectories, rate_hz: f64) -> Outcome<Vec<TrueEvent>> {
    let track = |name: &str| -> Outcome<Vec<[f64; 3]>> {
        let column = points.index(name).ok_or_else(|| format!("the motion lacks {name}"))?;
        Ok(points.frames.iter().map(|frame| frame[column]).collect())
    };
    let [left, right] = [track("LHip")?, track("RHip")?];
    let pelvis: Vec<[f64; 2]> =
        left.iter().zip(&right).map(|(a, b)| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]).collect();
    let way = [0, 1].map(|axis: usize| pelvis[pelvis.len() - 1][axis] - pelvis[0][axis]);
    let length = way[0].hypot(way[1]);
    let [x, y] = way.map(|x| x / length);
    let apart = (APART_S * rate_hz) as usize;
    let mut found = vec![];
    for (side, letter) in ["L", "R"].into_iter().enumerate() {
        for (is_strike, name, sign) in [(true, "Ankle", 1.0), (false, "BigToe", -1.0)] {
            let foot = track(&format!("{letter}{name}"))?;
            let ahead =
                |frame: usize| x * (foot[frame][0] - pelvis[frame][0]) + y * (foot[frame][1] - pelvis[frame][1]);
            let value = |frame: usize| sign * ahead(frame);
            let is_largest = |frame: &usize| {
                let near = frame.saturating_sub(apart)..(frame + apart + 1).min(foot.len());
                near.clone().all(|other| other == *frame || value(other) < value(*frame))
            };
            for frame in (1..foot.len() - 1).filter(is_largest) {
                let [a, b, c] = [frame - 1, frame, frame + 1].map(value);
                let extremum_s = (frame as f64 + 0.5 * (a - c) / (a - 2.0 * b + c)) / rate_hz;
                found.push(TrueEvent { side, is_strike, extremum_s, contact_s: extremum_s, place: None });
            }
        }
    }
    found.sort_by(|a, b| a.extremum_s.total_cmp(&b.extremum_s));
    Ok(found)
}

/// The parameters of a stride, in the order of the program's, by the times and places of true events; NaN where they do not exist.
pub(super) fn stride(events: &[TrueEvent], start: usize) -> Option<[f64; 10]> {
    let begin = &events[start];
    let rest = &events[start + 1..];
    let next = |side: usize, is_strike: bool| rest.iter().find(move |e| e.side == side && e.is_strike == is_strike);
    let (end, other) = (next(begin.side, true)?, next(1 - begin.side, true)?);
    let (off, other_off) = (next(begin.side, false)?, next(1 - begin.side, false)?);
    let [a, b, c] = [begin, other, end].map(|event| event.place.unwrap_or([f64::NAN; 2]));
    let time = end.extremum_s - begin.extremum_s;
    let length = (c[0] - a[0]).hypot(c[1] - a[1]);
    let stance = (off.extremum_s - begin.extremum_s) / time;
    let double = (other_off.extremum_s - begin.extremum_s + off.extremum_s - other.extremum_s) / time;
    // The walker goes straight ahead.
    let (step, width) = (c[1] - b[1], (b[0] - 0.5 * (a[0] + c[0])).abs());
    let step_s = end.extremum_s - other.extremum_s;
    Some([step, length, width, step_s, time, 120.0 / time, length / time, stance, 1.0 - stance, double])
}
