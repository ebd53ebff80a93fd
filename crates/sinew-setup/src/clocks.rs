//! Clocks of the cameras against each other.

use super::collect::Collected;
use super::warning::SetupWarning;
use sinew_formats::camera_name;
use sinew_input::lag::ClockLag;
use sinew_observe::Camera;
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::clocks::lag_estimate::{CameraLag, LagSearch, camera_clocks};

/// Frames below which no clock is judged, and seconds: in less, limbs swing too seldom to tell a camera that is late from one that is not quite where its calibration says.
const FEWEST: f64 = 60.0;
const LEAST_S: f64 = 1.5;

/// Whether frames are too few to judge clocks by.
#[must_use]
pub fn are_too_few(frames: usize, fps: Option<f64>) -> bool {
    (frames as f64) < fps.map_or(FEWEST, |fps| FEWEST.max(LEAST_S * fps))
}

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
    if are_too_few(runs.iter().map(|run| run.len()).sum(), fps) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found on top of what was declared is advised with it; where nothing is left to declare, no empty setting is.
    #[test]
    fn advice_is_never_an_empty_setting() {
        let camera = |name| Camera::look_at(name, [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let cameras = ["C1", "C2"].map(camera);
        let said = |declared: &str, frames: f64| {
            let declared = vec![("c2".to_owned(), declared.parse().unwrap())];
            let lags = [CameraLag::default(), CameraLag { frames, sd: 0.05 }];
            unsynchronised(&cameras, &declared, &lags).unwrap().to_string()
        };
        assert!(said("1", 2.0).ends_with("`--lag c2=3` reads the frames that belong together"), "{}", said("1", 2.0));
        let none = said("2", -2.0);
        assert!(none.ends_with("leave `--lag` out, which reads frames that do not belong together"), "{none}");
    }
}
