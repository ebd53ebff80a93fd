//! Clocks of the cameras against each other.

use super::collect::Collected;
use super::warning::SetupWarning;
use sinew_formats::camera_name;
use sinew_input::lag::ClockLag;
use sinew_observe::Camera;
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::clocks::lag_estimate::{CameraLag, LagSearch, camera_clocks};

/// Frames below which no clock is judged: the errors of the estimate come from blocks of fifteen frames, and fewer than four blocks say little of them.
const FEWEST: usize = 60;

/// Frames a second where nobody says.
pub const USUAL_FPS: f64 = 60.0;

/// Lags of all cameras in the runs of consecutive frames that were kept, of `fps` a second; empty where there is one camera, or too few frames.
#[must_use]
pub fn lags(
    cameras: &[Camera],
    collected: &Collected,
    (fps, offsets): (Option<f64>, offsets::Config),
) -> Vec<CameraLag> {
    let window = collected.window.as_slice();
    let end = window.last().map_or(0, |(number, _)| *number);
    let after = |run: &&[(u64, Sighted)]| run.first().is_some_and(|(number, _)| *number > end);
    let later = collected.later.iter().map(Vec::as_slice).filter(after);
    let runs: Vec<&[(u64, Sighted)]> = std::iter::once(window).chain(later).collect();
    if runs.iter().map(|run| run.len()).sum::<usize>() < FEWEST {
        return vec![];
    }
    let search = LagSearch { fps: fps.unwrap_or(USUAL_FPS), offsets, drifts: false };
    let taken = vec![0.0; cameras.len()];
    let clocks = camera_clocks((cameras, &taken), &runs, &search).unwrap_or_default();
    clocks.into_iter().map(|clock| clock.lag).collect()
}

/// The cameras that are off, with the setting that mends it: what was `declared` and what was found.
#[must_use]
pub fn unsynchronised(cameras: &[Camera], declared: &[(String, ClockLag)], lags: &[CameraLag]) -> Option<SetupWarning> {
    let off: Vec<(String, CameraLag)> = (cameras.iter().zip(lags))
        .filter(|(_, lag)| lag.is_off())
        .map(|(camera, lag)| (camera.name.clone(), *lag))
        .collect();
    if off.is_empty() {
        return None;
    }
    let mut mended: Vec<(String, ClockLag)> = declared.to_vec();
    for (camera, lag) in &off {
        let frames = lag.rounded();
        match mended.iter_mut().find(|(name, _)| camera_name::fold(name) == camera_name::fold(camera)) {
            Some((_, known)) => known.frames += frames,
            None => mended.push((camera.clone(), ClockLag { frames, ppm: 0.0 })),
        }
    }
    mended.retain(|(_, lag)| *lag != ClockLag::default());
    mended.sort_by(|a, b| a.0.cmp(&b.0));
    Some(SetupWarning::Unsynchronised { cameras: off, mended })
}
