//! What the set-up can say about the recording and its calibration before anything is tracked.

use super::clocks::{lags, unsynchronised};
use super::collect::{Collected, SetupRequest};
use super::setup_error::SetupError;
use super::space_points::points_in_space;
use super::warning::SetupWarning;
use sinew_core::estimators::median;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::cameras::cross_view::{lag_change, residual_by_lag, swapped_spans};
use sinew_observe::cameras::offsets::CameraNoise;

/// Largest lag that is tried, frames.
const LAG: i64 = 10;
/// Frames looked at for lags and swaps.
const WINDOW: usize = 120;
/// Frames in which the subject's place before the cameras is looked at.
const PLACES: usize = 20;

/// Cameras that show people although the subject, as the other cameras place them, is behind them.
fn behind(
    cameras: &[Camera],
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Option<SetupWarning> {
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
    (!names.is_empty()).then_some(SetupWarning::Behind { cameras: names.len(), of: cameras.len(), names })
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
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Result<(), SetupError> {
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
            return Err(SetupError::OtherRate { camera: camera.name.clone(), rate, from, to, change });
        }
    }
    Ok(())
}

/// Scatter, pixels, above which a calibration is doubted, per 1000 px of image diagonal.
const DOUBTFUL: f64 = 8.0;
/// Share of the frames with people below which a camera is said not to show the tracked one.
const HARDLY: f64 = 0.1;

/// Cameras whose calibration may be another one's.
fn doubtful_cameras(cameras: &[Camera], noise: &[CameraNoise], collected: &Collected) -> Vec<SetupWarning> {
    let mut warnings = vec![];
    for (c, (camera, noise)) in cameras.iter().zip(noise).enumerate() {
        let [width, height] = camera.image_size_px;
        let (shown, matched) = (collected.crowded[c], collected.matched[c]);
        if shown > 0 && (matched as f64) < HARDLY * shown as f64 {
            warnings.push(SetupWarning::Unmatched { camera: camera.name.clone(), shown, matched });
        } else if noise.sigma_px > DOUBTFUL * width.hypot(height) / 1000.0 {
            warnings.push(SetupWarning::Scatter { camera: camera.name.clone(), px: noise.sigma_px });
        }
    }
    warnings
}

/// Clocks, swapped sides, doubtful calibrations, and the subject's place before the cameras.
#[must_use]
pub fn oddities(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Vec<SetupWarning> {
    let mut warnings: Vec<SetupWarning> = behind(cameras, request, noise, collected).into_iter().collect();
    if warnings.is_empty() {
        warnings.extend(doubtful_cameras(cameras, noise, collected));
    }
    let window = &collected.window[..collected.window.len().min(WINDOW)];
    let least = request.offsets.least_confidence;
    let pairs = layout.left_right_pairs();
    for (c, camera) in cameras.iter().enumerate() {
        let swapped = swapped_spans(cameras, noise, window, c, &pairs, least);
        warnings.extend(swapped.into_iter().map(|s| SetupWarning::Swapped {
            camera: camera.name.clone(),
            first: s.first,
            last: s.last,
            residual_px: s.residual_px,
            swapped_px: s.swapped_px,
        }));
    }
    let own = || lags(cameras, collected, (request.fps, request.offsets));
    warnings.extend(unsynchronised(cameras, &request.lag, &request.lags_of_all.clone().unwrap_or_else(own)));
    warnings
}
