//! What the set-up can say about the recording and its calibration before anything is tracked.

use super::collect::{Collected, Request};
use super::shape::{Points, points_in_space};
use super::warning::Warning;
use crate::Error;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::cross_view::{best_lag, lag_change, residual_by_lag, swapped_spans};
use sinew_observe::offsets::{CameraNoise, median};

/// Largest lag that is tried, frames.
const LAG: i64 = 10;
/// A lag counts where the residual falls below this share of what it is without.
const LAG_SHARE: f64 = 0.8;
/// Frames looked at for lags and swaps.
const WINDOW: usize = 120;
/// A body outside these multiples of the default is none.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.2..=5.0;
/// Body heights between a camera and the origin that are too many.
const FAR: f64 = 100.0;
/// Height of the default body, metres.
const HEIGHT_M: f64 = 1.75;

/// Median distance of the cameras from the origin, in the unit of the calibration.
fn usual_distance(cameras: &[Camera]) -> f64 {
    median(
        &mut cameras.iter().map(|camera| camera.centre().iter().map(|x| x * x).sum::<f64>().sqrt()).collect::<Vec<_>>(),
    )
}

/// Refuses units that make a body of the wrong size.
///
/// # Errors
/// The size is that of no person.
pub fn check_scale(cameras: &[Camera], scale: f64) -> Result<(), Error> {
    if PLAUSIBLE.contains(&scale) {
        return Ok(());
    }
    let (message, help) = match far_cameras(cameras) {
        Some(warning) if scale > 1.0 => (warning.to_string(), "give the translations of the calibration in metres"),
        _ => (
            format!(
                "the person would be {:.3} m tall; are translations in metres, and do the cameras' poses belong to these images?",
                scale * HEIGHT_M
            ),
            "give translations in metres, and the camera from the world, `Xcam = R Xworld + t`",
        ),
    };
    Err(Error::Input { message, help: Some(help.into()) })
}

/// Warns when cameras stand so far from the origin that metres are unlikely.
#[must_use]
pub fn far_cameras(cameras: &[Camera]) -> Option<Warning> {
    let distance = usual_distance(cameras);
    (distance > FAR * HEIGHT_M).then_some(Warning::Millimetres { distance, height: HEIGHT_M })
}

/// The rotation that takes a world whose `up` axis is one of `+x`, `-x`, `+y`, `-y`, `+z`, `-z` to one with z up, for [`Camera::turned`]; `None` for other names.
#[must_use]
pub fn z_up_from(up: &str) -> Option<[[f64; 3]; 3]> {
    Some(match up {
        "+x" => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        "-x" => [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]],
        "+y" => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        "-y" => [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        "+z" => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        "-z" => [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
        _ => return None,
    })
}

const AXES: [[&str; 2]; 3] = [["-x", "+x"], ["-y", "+y"], ["-z", "+z"]];
const LOW: [&str; 6] = ["LAnkle", "RAnkle", "LHeel", "RHeel", "LKnee", "RKnee"];
const HIGH: [&str; 6] = ["Head", "Nose", "Neck", "LShoulder", "RShoulder", "MidShoulder"];

/// World axis nearest to the median direction from feet to head; `+z` where nothing is known.
#[must_use]
pub fn up_axis(layout: &Layout, frames: &[(u64, Points)]) -> &'static str {
    let mut directions: [Vec<f64>; 3] = [vec![], vec![], vec![]];
    for (_, points) in frames {
        let middle = |names: &[&str]| {
            let found: Vec<[f64; 3]> =
                names.iter().filter_map(|n| Some(points.get(layout.index(n)?).copied().flatten()?.0)).collect();
            let count = found.len() as f64;
            (!found.is_empty()).then(|| [0, 1, 2].map(|k: usize| found.iter().map(|p| p[k]).sum::<f64>() / count))
        };
        if let (Some(low), Some(high)) = (middle(&LOW), middle(&HIGH)) {
            for k in 0..3 {
                directions[k].push(high[k] - low[k]);
            }
        }
    }
    let direction = directions.map(|mut d| median(&mut d));
    let largest = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap_or(2);
    if direction[largest].is_nan() { "+z" } else { AXES[largest][usize::from(direction[largest] > 0.0)] }
}

/// Frames in which the subject's place before the cameras is looked at.
const PLACES: usize = 20;

/// Cameras that show people although the subject, as the other cameras place him, is behind them.
fn behind(cameras: &[Camera], request: &Request, noise: &[CameraNoise], collected: &Collected) -> Option<Warning> {
    let mut counts = vec![(0, 0); cameras.len()];
    for (_, sighted) in collected.window.iter().step_by(collected.window.len().div_ceil(PLACES).max(1)) {
        let points = points_in_space(cameras, noise, sighted, request.offsets.least_confidence);
        for (camera, count) in cameras.iter().zip(&mut counts) {
            let mut depths: Vec<f64> = points.iter().flatten().map(|(p, _)| camera.point_in_camera(*p)[2]).collect();
            let depth = median(&mut depths);
            count.0 += usize::from(depth <= 0.0);
            count.1 += usize::from(depth.is_finite());
        }
    }
    let is_behind = |c: usize| 2 * counts[c].0 > counts[c].1 && collected.crowded.get(c).is_some_and(|n| *n > 0);
    let names: Vec<String> = (0..cameras.len()).filter(|&c| is_behind(c)).map(|c| cameras[c].name.clone()).collect();
    (!names.is_empty()).then_some(Warning::Behind { cameras: names.len(), of: cameras.len(), names })
}

/// Change of lag, frames, at which frame rates are said to differ.
const DRIFT: i64 = 2;

/// Frames that a later window needs, and how many windows are looked at, the last ones.
const FEWEST_LATER: usize = 40;
const LATER_CHECKED: usize = 3;

/// Refuses cameras whose lag against the others changes in the course of the recording.
///
/// # Errors
/// The camera, its rate against that of the others, and where that was seen.
pub fn same_rate(
    cameras: &[Camera],
    request: &Request,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Result<(), Error> {
    let least = request.offsets.least_confidence;
    let early = &collected.window[..collected.window.len().min(WINDOW)];
    let middle = |frames: &[(u64, _)]| frames.get(frames.len() / 2).map(|(number, _): &(u64, _)| *number);
    for late in collected.later.iter().rev().filter(|late| late.len() >= FEWEST_LATER).take(LATER_CHECKED) {
        let mut drifts = cameras.iter().enumerate().filter_map(|(c, camera)| {
            let by_lag = |frames| residual_by_lag(cameras, noise, frames, c, LAG, least);
            let change = lag_change(&by_lag(early)?, &by_lag(late)?)?;
            (change.abs() >= DRIFT).then_some((camera, change))
        });
        if let (Some((camera, change)), Some(from), Some(to)) = (drifts.next(), middle(early), middle(late)) {
            let rate = 1.0 + change as f64 / (to - from) as f64;
            return Err(Error::Input {
                message: format!(
                    "{} records {rate:.4} frames for each frame of the other cameras: from frame {from} to {to} its lag changes by {change:+} frames",
                    camera.name
                ),
                help: Some("resample the keypoints to one frame rate, or leave the camera out of `--cameras`".into()),
            });
        }
    }
    Ok(())
}

/// Scatter, pixels, above which a calibration is doubted, per 1000 px of image diagonal.
const DOUBTFUL: f64 = 8.0;
/// Share of the frames with people below which a camera is said not to show the tracked one.
const HARDLY: f64 = 0.1;

/// Cameras whose calibration may be another one's.
fn doubtful_cameras(cameras: &[Camera], noise: &[CameraNoise], collected: &Collected) -> Vec<Warning> {
    let mut warnings = vec![];
    for (c, (camera, noise)) in cameras.iter().zip(noise).enumerate() {
        let [width, height] = camera.image_size_px;
        let (shown, matched) = (collected.crowded[c], collected.matched[c]);
        if shown > 0 && (matched as f64) < HARDLY * shown as f64 {
            warnings.push(Warning::Unmatched { camera: camera.name.clone(), shown, matched });
        } else if noise.sigma_px > DOUBTFUL * width.hypot(height) / 1000.0 {
            warnings.push(Warning::Scatter { camera: camera.name.clone(), px: noise.sigma_px });
        }
    }
    warnings
}

/// The name, in a world whose axis `declared` was turned to z, of the axis that is now called `turned`: what is to be declared instead.
#[must_use]
pub fn axis_before_turning(turned: &str, declared: &str) -> &'static str {
    let along = |name: &str| {
        let axis = ["x", "y", "z"].iter().position(|axis| name.ends_with(axis)).unwrap_or(2);
        (axis, if name.starts_with('-') { -1.0 } else { 1.0 })
    };
    let (row, sign) = along(turned);
    let before = z_up_from(declared).map_or([0.0, 0.0, 1.0], |turn| turn[row].map(|x| sign * x));
    let axis = (0..3).find(|&k| before[k] != 0.0).unwrap_or(2);
    AXES[axis][usize::from(before[axis] > 0.0)]
}

/// Clocks, swapped sides, doubtful calibrations, and the subject's place before the cameras.
#[must_use]
pub fn oddities(
    cameras: &[Camera],
    layout: &Layout,
    request: &Request,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Vec<Warning> {
    let mut warnings: Vec<Warning> = behind(cameras, request, noise, collected).into_iter().collect();
    if warnings.is_empty() {
        warnings.extend(doubtful_cameras(cameras, noise, collected));
    }
    let window = &collected.window[..collected.window.len().min(WINDOW)];
    let least = request.offsets.least_confidence;
    let pairs = layout.left_right_pairs();
    for (c, camera) in cameras.iter().enumerate() {
        let swapped = swapped_spans(cameras, noise, window, c, &pairs, least);
        warnings.extend(swapped.into_iter().map(|s| Warning::Swapped {
            camera: camera.name.clone(),
            first: s.first,
            last: s.last,
            residual_px: s.residual_px,
            swapped_px: s.swapped_px,
        }));
        if let Some(lag) = residual_by_lag(cameras, noise, window, c, LAG, least).and_then(|by_lag| best_lag(&by_lag))
            && lag.frames != 0
            && lag.best_px < LAG_SHARE * lag.now_px
        {
            warnings.push(Warning::Unsynchronised {
                camera: camera.name.clone(),
                lag: lag.frames,
                best_px: lag.best_px,
                now_px: lag.now_px,
            });
        }
    }
    warnings
}
