//! How late the cameras of a recording are against each other, from how the person moves.
//!
//! 1. Whole frames, however many, from where rays meet ([`sinew_observe::clock_search`]), in the first `SEARCHED` frames.
//! 2. The recording is read with them, `WINDOWS` windows of it, evenly spread, and the person is followed in each.
//! 3. Fractions of a frame and drifts from the person's motion ([`sinew_observe::camera_lag`]). Where a whole frame is left, 2 and 3 are done again.
//!
//! Drifts are taken where the data tell one of them from 0 (`CERTAIN` standard deviations); without any, all lags are estimated again, without drifts.

use crate::Error;
use sinew::input::lag::Lag;
use sinew::input::recording::{Recording, RecordingOptions, lag_of};
use sinew::observe::Camera;
use sinew::observe::association;
use sinew::observe::camera_lag::{CameraClock, CameraLag, camera_clocks};
use sinew::observe::clock_search::whole_lags;
use sinew::observe::following::{Following, follow};
use sinew::observe::offsets::{self, Sighted};
use sinew::setup::SetupError;
use std::ops::Range;
use std::path::Path;

/// Frames in which whole lags are searched for.
const SEARCHED: u64 = 1200;
/// Windows in which the person is followed, and their frames.
const WINDOWS: u64 = 24;
const WINDOW: u64 = 100;
/// Times that fractions are estimated.
const ROUNDS: usize = 4;
/// Frames from which offsets are estimated.
const OFFSET_FRAMES: usize = 150;
/// Standard deviations by which a drift differs from 0.
const CERTAIN: f64 = 4.0;
/// Standard deviation of a lag of which nothing is known, frames.
const UNKNOWN: f64 = 2.0;

/// The clock of a camera, against the cameras that agree with each other, or against the first.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundClock {
    /// Camera.
    pub camera: String,
    /// Frames that it is late in the middle of the recording, and their standard deviation; `None` where the motion says nothing.
    pub lag: Option<CameraLag>,
    /// Frames that it falls behind in a million, and their standard deviation; `None` where no camera drifts beyond doubt.
    pub drift_ppm: Option<[f64; 2]>,
    /// The setting `lag` that mends it.
    pub declared: Lag,
}

/// What is known of all clocks.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundClocks {
    /// Every camera.
    pub cameras: Vec<FoundClock>,
    /// Frames in which the person was followed.
    pub frames: usize,
}

impl FoundClocks {
    /// The setting `lag` for all cameras that need one, as typed; `None` where all are in step.
    #[must_use]
    pub fn setting(&self) -> Option<String> {
        let late = self.cameras.iter().filter(|clock| clock.declared != Lag::default());
        let texts: Vec<String> = late.map(|clock| format!("{}={}", clock.camera, clock.declared)).collect();
        (!texts.is_empty()).then(|| texts.join(","))
    }
}

/// Finds the clocks of the cameras, at most `most` frames apart beyond the lags of `options`; `watch` is called before each frame that is read and may stop.
///
/// # Errors
/// A recording that cannot be read; one camera; nobody whom two cameras see; errors of `watch`.
pub fn synchronise<E: From<Error>>(
    calibration: &Path,
    keypoints: &Path,
    options: &RecordingOptions,
    most: u64,
    mut watch: impl FnMut() -> Result<(), E>,
) -> Result<FoundClocks, E> {
    let library = |error: sinew::RecordingError| E::from(error.into());
    let open = |lag: &[(String, Lag)]| {
        let options = RecordingOptions { lag: lag.to_vec(), trim: true, ..options.clone() };
        Recording::open(calibration, keypoints, &options)
    };
    let mut recording = open(&options.lag).map_err(library)?;
    let cameras = recording.cameras().to_vec();
    if cameras.len() < 2 {
        return Err(E::from(SyncError::OneCamera.into()));
    }
    let declared: Vec<Lag> = cameras.iter().map(|camera| lag_of(&options.lag, &camera.name)).collect();
    let searched = windows(&recording.frames(), 1, SEARCHED).remove(0);
    let mut first = vec![];
    for number in searched {
        watch()?;
        first.push(recording.people(number).map_err(library)?);
    }
    let whole = whole_lags(&cameras, &first, most as usize, &association::Config::default());
    drop(first);
    let mut late: Vec<Lag> = (declared.iter().zip(&whole))
        .map(|(declared, whole)| Lag { frames: declared.frames + *whole as f64, ..*declared })
        .collect();
    let mut round = 0;
    loop {
        let named: Vec<(String, Lag)> = cameras.iter().map(|camera| camera.name.clone()).zip(late.clone()).collect();
        let mut recording = open(&named).map_err(library)?;
        let runs = followed(&mut recording, &mut watch)?;
        let (clocks, drifts) = estimated(&cameras, &runs)
            .ok_or_else(|| E::from(SetupError::NoAgreement { cameras: cameras.len(), frames: SEARCHED }.into()))?;
        round += 1;
        if round < ROUNDS && clocks.iter().any(|clock| clock.lag.frames.abs() >= 1.0) {
            late.iter_mut().zip(&clocks).for_each(|(late, clock)| late.frames += clock.lag.frames.round());
            continue;
        }
        let found = cameras.iter().zip(&late).zip(&declared).zip(&clocks);
        let found = found.map(|(((camera, late), declared), clock)| clock_of(camera, *late, *declared, clock, drifts));
        return Ok(FoundClocks { cameras: found.collect(), frames: runs.iter().map(Vec::len).sum() });
    }
}

/// Why there is nothing to synchronise.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SyncError {
    /// One camera.
    #[error("one camera: there is no other clock to compare its own with")]
    OneCamera,
}

impl SyncError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        2
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        "give keypoints of two cameras or more"
    }
}

/// At most `count` windows of some frames, evenly spread; one of all frames where they would touch.
fn windows(frames: &Range<u64>, count: u64, width: u64) -> Vec<Range<u64>> {
    let all = frames.end - frames.start;
    if all <= count * width {
        return vec![frames.clone()];
    }
    let last = all - width;
    let start = |k: u64| frames.start + if count > 1 { k * last / (count - 1) } else { 0 };
    (0..count).map(|k| start(k)..start(k) + width).collect()
}

/// The person in windows of the recording: frames with what the cameras show of him.
fn followed<E: From<Error>>(
    recording: &mut Recording,
    mut watch: impl FnMut() -> Result<(), E>,
) -> Result<Vec<Vec<(u64, Sighted)>>, E> {
    let config = association::Config::default();
    let cameras = recording.cameras().to_vec();
    let mut runs = vec![];
    for window in windows(&recording.frames(), WINDOWS, WINDOW) {
        let mut following = Following::default();
        let mut run = vec![];
        for number in window {
            watch()?;
            let people = recording.people(number).map_err(|error| E::from(error.into()))?;
            let found = follow(&mut following, &cameras, &people, None, &config);
            if found.is_present() {
                run.push((number, found.people));
            }
        }
        runs.push(run);
    }
    Ok(runs)
}

/// Clocks with drifts where one of them is certain, else without.
fn estimated(cameras: &[Camera], runs: &[Vec<(u64, Sighted)>]) -> Option<(Vec<CameraClock>, bool)> {
    let all: Vec<&Sighted> = runs.iter().flatten().map(|(_, sighted)| sighted).collect();
    let stride = all.len().div_ceil(OFFSET_FRAMES).max(1);
    let some: Vec<Sighted> = all.into_iter().step_by(stride).cloned().collect();
    if some.is_empty() {
        return None;
    }
    let config = offsets::Config::default();
    let noise = offsets::estimate(cameras, &some, &config);
    let runs: Vec<&[(u64, Sighted)]> = runs.iter().map(Vec::as_slice).collect();
    let clocks = |drifts| camera_clocks(cameras, &noise, &runs, config.least_confidence, drifts);
    let with = clocks(true)?;
    let drifts = with.iter().any(|clock| clock.drift[0].abs() > CERTAIN * clock.drift[1]);
    Some((if drifts { with } else { clocks(false)? }, drifts))
}

/// The clock of a camera that was read with the lag `late`, beyond which `clock` is left.
fn clock_of(camera: &Camera, late: Lag, declared: Lag, clock: &CameraClock, drifts: bool) -> FoundClock {
    let name = camera.name.clone();
    if clock.lag.sd > UNKNOWN {
        return FoundClock { camera: name, lag: None, drift_ppm: None, declared };
    }
    let middle = late.frames + 1e-6 * late.ppm * clock.middle + clock.lag.frames;
    let lag = CameraLag { frames: middle, sd: clock.lag.sd };
    let ppm = late.ppm + 1e6 * clock.drift[0];
    let declared = match drifts {
        false => Lag { frames: lag.rounded(), ppm: late.ppm },
        true => {
            let ppm = (10.0 * ppm).round() / 10.0;
            Lag { frames: (100.0 * (middle - 1e-6 * ppm * clock.middle)).round() / 100.0, ppm }
        }
    };
    let drift_ppm = drifts.then_some([ppm, 1e6 * clock.drift[1]]);
    FoundClock { camera: name, lag: Some(lag), drift_ppm, declared }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_spread_from_the_first_frame_to_the_last() {
        assert_eq!(windows(&(5..300), 3, 100), [5..300]);
        assert_eq!(windows(&(5..1005), 3, 100), [5..105, 455..555, 905..1005]);
        assert_eq!(windows(&(5..1005), 1, 100), [5..105]);
    }

    #[test]
    fn a_setting_names_cameras_that_are_not_in_step() {
        let clock = |camera: &str, declared| FoundClock { camera: camera.into(), lag: None, drift_ppm: None, declared };
        let drifting = Lag { frames: -1.25, ppm: 80.0 };
        let cameras = vec![clock("a", Lag::default()), clock("b", Lag::whole(2)), clock("c", drifting)];
        let found = FoundClocks { cameras, frames: 1 };
        assert_eq!(found.setting().as_deref(), Some("b=2,c=-1.25+80ppm"));
        assert_eq!(FoundClocks { cameras: vec![], frames: 1 }.setting(), None);
    }
}
