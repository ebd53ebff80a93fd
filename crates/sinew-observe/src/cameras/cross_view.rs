//! What the other cameras say about one. Is its clock off, has it swapped left and right, does the subject stand behind it?
//!
//! A keypoint is triangulated from all cameras but one and projected into that one, offsets included ([`expected_from_others`]). Then
//!
//! - [`residual_by_lag`]: the median distance of its detections of frame f + lag from what is expected in frame f, its own median offset removed, has its least
//!   value at the lag of its clock ([`best_lag`]), and a lag that changes means another frame rate ([`lag_change`]);
//! - [`swapped_spans`]: frames in which the distance falls to less than half when left and right are exchanged;
//! - [`cameras_behind`]: cameras whose optical axis the subject lies behind.

use crate::association::Person;
use crate::cameras::camera::Camera;
use crate::cameras::offsets::{CameraNoise, Sighted, point_from_views};
use crate::cameras::triangulate::{Seen, linear};
use sinew_core::estimators::median;

/// Pixels in camera `camera` that the other cameras' detections lead to expect; all `None` with fewer than two others.
#[must_use]
pub fn expected_from_others(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frame: &Sighted,
    camera: usize,
    least_confidence: f64,
) -> Vec<Option<[f64; 2]>> {
    let mut others = frame.clone();
    if let Some(own) = others.get_mut(camera) {
        own.clear();
    }
    let keypoints = frame.iter().map(Vec::len).max().unwrap_or(0);
    (0..keypoints)
        .map(|k| {
            let (found, _) = point_from_views(cameras, noise, &others, k, least_confidence)?;
            let [u, v] = cameras.get(camera)?.project(found.point).pixel()?;
            let [du, dv] = noise[camera].offset_px;
            Some([u + du, v + dv])
        })
        .collect()
}

/// A camera's clock against the others'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lag {
    /// Frames by which the camera's detections must be shifted to fit best.
    pub frames: i64,
    /// Median residual there, pixels.
    pub best_px: f64,
    /// Median residual without a shift, pixels.
    pub now_px: f64,
}

/// Lags that a recording must be long, so that what overlaps at the largest one says something.
const LENGTH_IN_LAGS: i64 = 3;

/// Comparisons below which a lag is not judged.
const FEWEST: usize = 50;

/// Median residual, pixels, of one camera at each lag from −`most` to `most`, from consecutive frames (number, detections); `None` where there is too little to compare:
/// fewer frames than three times `most`, or few keypoints. A lag counts only where it leaves half of the comparisons that there are without one.
#[must_use]
pub fn residual_by_lag(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frames: &[(u64, Sighted)],
    camera: usize,
    most: i64,
    least_confidence: f64,
) -> Option<Vec<(i64, f64)>> {
    if i64::try_from(frames.len()).is_ok_and(|length| length < LENGTH_IN_LAGS * most) {
        return None;
    }
    let expected: Vec<Vec<Option<[f64; 2]>>> =
        frames.iter().map(|(_, f)| expected_from_others(cameras, noise, f, camera, least_confidence)).collect();
    let residual = |lag: i64| {
        let mut errors: [Vec<f64>; 2] = [vec![], vec![]];
        for (f, (number, _)) in frames.iter().enumerate() {
            let shifted = i64::try_from(f).ok()?.checked_add(lag)?;
            let Some((other, seen)) = usize::try_from(shifted).ok().and_then(|i| frames.get(i)) else { continue };
            if other.wrapping_sub(*number) as i64 != lag {
                continue;
            }
            for (e, d) in expected[f].iter().zip(&seen[camera]) {
                if let (Some(e), Some(d)) = (e, d)
                    && d.confidence >= least_confidence
                {
                    errors[0].push(d.pixel[0] - e[0]);
                    errors[1].push(d.pixel[1] - e[1]);
                }
            }
        }
        let compared = errors[0].len();
        if compared < FEWEST {
            return None;
        }
        let middle = [median(&mut errors[0].clone()), median(&mut errors[1].clone())];
        let mut distances: Vec<f64> =
            errors[0].iter().zip(&errors[1]).map(|(u, v)| (u - middle[0]).hypot(v - middle[1])).collect();
        Some((median(&mut distances), compared))
    };
    let (_, all) = residual(0)?;
    let enough = |lag| residual(lag).filter(|(_, compared)| 2 * compared >= all).map(|(px, _)| (lag, px));
    Some((-most..=most).filter_map(enough).collect())
}

/// The lag with the least residual in [`residual_by_lag`], the smaller one of equals.
#[must_use]
pub fn best_lag(residuals: &[(i64, f64)]) -> Option<Lag> {
    let (_, now_px) = *residuals.iter().find(|(lag, _)| *lag == 0)?;
    let key = |(lag, px): &(i64, f64)| (*px, lag.abs());
    let best = residuals.iter().min_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal))?;
    Some(Lag { frames: best.0, best_px: best.1, now_px })
}

/// Share of the residual at another window's lag that the own lag leaves at most, where clocks are said to run apart.
const DECISIVE: f64 = 0.6;

/// Change of a camera's lag, frames, between two windows of a recording, given the residuals of each ([`residual_by_lag`]); `None` unless each window speaks decidedly
/// against the lag of the other.
#[must_use]
pub fn lag_change(early: &[(i64, f64)], late: &[(i64, f64)]) -> Option<i64> {
    let (first, last) = (best_lag(early)?, best_lag(late)?);
    let at = |residuals: &[(i64, f64)], wanted: i64| residuals.iter().find(|(lag, _)| *lag == wanted).map(|r| r.1);
    let against = |own: Lag, residuals, other: Lag| Some(own.best_px < DECISIVE * at(residuals, other.frames)?);
    (against(first, early, last)? && against(last, late, first)?).then_some(last.frames - first.frames)
}

/// Frames in which a camera seems to have exchanged left and right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwappedSpan {
    /// First frame.
    pub first: u64,
    /// Last frame.
    pub last: u64,
    /// Median residual as labelled, pixels.
    pub residual_px: f64,
    /// Median residual with left and right exchanged, pixels.
    pub swapped_px: f64,
}

/// Frames that a span has at least.
const SPAN: usize = 3;
/// Frames of another opinion that do not end a span.
const PATIENCE: usize = 2;

/// Spans of frames in which exchanging `pairs` (left, right) of keypoints lowers the residual of a camera to less than half, and by more than three times its
/// scatter.
#[must_use]
pub fn swapped_spans(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frames: &[(u64, Sighted)],
    camera: usize,
    pairs: &[(usize, usize)],
    least_confidence: f64,
) -> Vec<SwappedSpan> {
    let sigma = noise.get(camera).map_or(f64::NAN, |n| n.sigma_px);
    let judged: Vec<(u64, Option<(f64, f64)>)> = frames
        .iter()
        .map(|(number, frame)| {
            let expected = expected_from_others(cameras, noise, frame, camera, least_confidence);
            let distance = |seen: usize, at: usize| {
                let d = frame[camera].get(seen).copied().flatten().filter(|d| d.confidence >= least_confidence)?;
                let [u, v] = expected.get(at).copied().flatten()?;
                Some((d.pixel[0] - u).hypot(d.pixel[1] - v))
            };
            let (mut straight, mut crossed) = (vec![], vec![]);
            for &(l, r) in pairs {
                for (a, b) in [(l, r), (r, l)] {
                    if let (Some(s), Some(c)) = (distance(a, a), distance(a, b)) {
                        straight.push(s);
                        crossed.push(c);
                    }
                }
            }
            let (straight, crossed) = (median(&mut straight), median(&mut crossed));
            (*number, (crossed < 0.5 * straight && straight - crossed > 3.0 * sigma).then_some((straight, crossed)))
        })
        .collect();
    let mut spans = vec![];
    let mut members: Vec<(u64, f64, f64)> = vec![];
    let mut quiet = 0;
    let mut close = |members: &mut Vec<(u64, f64, f64)>| {
        if let ([(first, ..), .., (last, ..)], true) = (&members[..], members.len() >= SPAN) {
            let of = |value: fn(&(u64, f64, f64)) -> f64| median(&mut members.iter().map(value).collect::<Vec<_>>());
            spans.push(SwappedSpan { first: *first, last: *last, residual_px: of(|m| m.1), swapped_px: of(|m| m.2) });
        }
        members.clear();
    };
    for (number, judgement) in judged {
        match judgement {
            Some((straight, crossed)) => {
                members.push((number, straight, crossed));
                quiet = 0;
            }
            None => {
                quiet += 1;
                if quiet > PATIENCE {
                    close(&mut members);
                }
            }
        }
    }
    close(&mut members);
    spans
}

/// Number of cameras that the most complete people of a frame lie behind, if triangulated as though they were one person, and of how many.
#[must_use]
pub fn cameras_behind(cameras: &[Camera], people: &[Vec<Person>]) -> (usize, usize) {
    let count = |p: &Person| p.iter().flatten().count();
    let chosen: Vec<(&Camera, &Person)> = cameras
        .iter()
        .zip(people)
        .filter_map(|(camera, people)| Some((camera, people.iter().max_by_key(|p| count(p))?)))
        .collect();
    let keypoints = chosen.iter().map(|(_, p)| p.len()).max().unwrap_or(0);
    let points: Vec<[f64; 3]> = (0..keypoints)
        .filter_map(|k| {
            let seen: Vec<Seen<'_>> = chosen
                .iter()
                .filter_map(|(camera, p)| {
                    let d = p.get(k).copied().flatten()?;
                    Some(Seen { camera, pixel: d.pixel, confidence: d.confidence })
                })
                .collect();
            linear(&seen, true)
        })
        .collect();
    let behind = |camera: &Camera| {
        2 * points.iter().filter(|p| camera.point_in_camera(**p)[2] <= 0.0).count() > points.len().max(1)
    };
    (chosen.iter().filter(|(camera, _)| behind(camera)).count(), chosen.len())
}
