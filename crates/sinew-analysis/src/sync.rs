//! How late the cameras of a recording are against each other, from how people move.
//!
//! 1. Whole frames, however many, from where rays meet ([`sinew_observe::clocks::clock_search`]), in the first `SEARCHED` frames.
//! 2. The recording is read with them, `WINDOWS` windows of it, evenly spread, and everybody is followed in each.
//! 3. Fractions of a frame and drifts from their motion ([`sinew_observe::clocks::lag_estimate`]). Where a whole frame is left, 2 and 3 are done again.
//!
//! Two or three views of a person who walks straight ahead say little of whole lags: 2 and 3 are done from no lags at all, too, and what brings the cameras nearer together is taken.

pub mod error;

use crate::Error;
use error::SyncError;
use sinew::input::lag::ClockLag;
use sinew::input::recording::{Recording, RecordingOptions, lag_of};
use sinew::input::roll::Roll;
use sinew::observe::Camera;
use sinew::observe::association::following::{Following, follow};
use sinew::observe::association::{self, Person};
use sinew::observe::cameras::offsets::{self, Sighted};
use sinew::observe::clocks::clock_search::whole_lags;
use sinew::observe::clocks::lag_estimate::{CameraClock, CameraLag, LagSearch, camera_clocks};
use sinew::setup::SetupError;
use sinew::setup::clocks::{SightedRun, are_too_few, seen, windows};
use std::ops::Range;
use std::path::Path;

/// Frames in which whole lags are searched for.
const SEARCHED: usize = 1200;
/// Times that fractions are estimated.
const ROUNDS: usize = 4;
/// Frames from which offsets are estimated.
const OFFSET_FRAMES: usize = 150;
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
    pub declared: ClockLag,
}

/// What is known of all clocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FoundClocks {
    /// Every camera.
    pub cameras: Vec<FoundClock>,
    /// Frames in which the person was followed.
    pub frames: usize,
    /// The frames that all cameras have, where they have not the same ones.
    pub common: Option<Range<u64>>,
    /// Whether that is too short to tell a lag from what a camera is off by.
    pub is_short: bool,
}

impl FoundClocks {
    /// The setting `lag` for all cameras that need one, as typed; `None` where all are in step.
    #[must_use]
    pub fn setting(&self) -> Option<String> {
        let late = self.cameras.iter().filter(|clock| clock.declared != ClockLag::default());
        let texts: Vec<String> = late.map(|clock| format!("{}={}", clock.camera, clock.declared)).collect();
        (!texts.is_empty()).then(|| texts.join(","))
    }
}

/// How clocks are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SyncRequest {
    /// Frames that cameras are apart at most, beyond the lags that are declared.
    pub most: u64,
    /// Frames a second.
    pub fps: f64,
}

/// Finds the clocks of the cameras of a recording that is read with `options`; `watch` is called before each frame that is read and may stop.
///
/// # Errors
/// A recording that cannot be read; one camera; nobody whom two cameras see; errors of `watch`.
pub fn synchronise<E: From<Error>>(
    calibration: &Path,
    keypoints: &Path,
    options: &RecordingOptions,
    request: &SyncRequest,
    mut watch: impl FnMut() -> Result<(), E>,
) -> Result<FoundClocks, E> {
    let library = |error: sinew_input::Error| E::from(error.into());
    let open = |lag: &[(String, ClockLag)]| {
        let options = RecordingOptions { lag: lag.to_vec(), trim: true, ..options.clone() };
        Recording::open(calibration, keypoints, &options)
    };
    let mut recording = open(&options.lag).map_err(library)?;
    let cameras = recording.cameras().to_vec();
    if cameras.len() < 2 {
        return Err(E::from(SyncError::OneCamera.into()));
    }
    let common = Recording::open(calibration, keypoints, options).is_err().then(|| recording.frames());
    let declared: Vec<ClockLag> = cameras.iter().map(|camera| lag_of(&options.lag, &camera.name)).collect();
    let mut first = vec![];
    for number in recording.frames().take(SEARCHED) {
        watch()?;
        first.push(recording.people(number).map_err(library)?);
    }
    let whole = whole_lags(&cameras, &first, request.most as usize, &association::Config::default());
    drop(first);
    let mut best: Option<(f64, FoundClocks)> = None;
    let none = vec![0; cameras.len()];
    let starts = if whole == none { vec![none] } else { vec![whole, none] };
    for start in starts {
        let mut late: Vec<ClockLag> = (declared.iter().zip(start))
            .map(|(declared, whole)| ClockLag { frames: declared.frames + whole as f64, ..*declared })
            .collect();
        for round in 1..=ROUNDS {
            let names = cameras.iter().map(|camera| camera.name.clone());
            let Ok(mut recording) = open(&names.zip(late.clone()).collect::<Vec<_>>()) else { break };
            let runs = followed(&mut recording, request.fps, &mut watch)?;
            let Some((clocks, misfit)) = estimated(&cameras, &late, &runs, request.fps) else { break };
            let left = |(clock, late): (&CameraClock, &ClockLag)| {
                is_known(clock) && (clock.lag.frames - late.frames).abs() >= 1.5
            };
            if round < ROUNDS && clocks.iter().zip(&late).any(left) {
                let known = late.iter_mut().zip(&clocks).filter(|(_, clock)| is_known(clock));
                known.for_each(|(late, clock)| late.frames = clock.lag.frames.round());
                continue;
            }
            if best.as_ref().is_none_or(|(least, _)| misfit < *least) {
                let found = cameras.iter().zip(&late).zip(&declared).zip(&clocks);
                let most = request.most as f64 + 0.5;
                let cameras =
                    found.map(|(((camera, late), declared), clock)| clock_of(camera, *late, (*declared, most), clock));
                let frames = runs.iter().map(Vec::len).sum();
                let is_short = are_too_few(frames, Some(request.fps));
                let unknown = |clock: FoundClock| FoundClock { lag: None, drift_ppm: None, ..clock };
                let cameras = cameras.zip(&declared).map(|(clock, declared)| match is_short {
                    true => unknown(FoundClock { declared: *declared, ..clock }),
                    false => clock,
                });
                let found = FoundClocks { cameras: cameras.collect(), frames, common: common.clone(), is_short };
                best = Some((misfit, found));
            }
            break;
        }
    }
    let nobody = || SetupError::NoAgreement { cameras: cameras.len(), frames: SEARCHED as u64 };
    best.map(|(_, found)| found).ok_or_else(|| E::from(Error::from(nobody())))
}

fn is_known(clock: &CameraClock) -> bool {
    clock.lag.sd < UNKNOWN
}

/// People in windows of the recording: for each, frames with what the cameras show of them.
///
/// Where views show one person each, that person is followed; where they show several, everybody is named, so that nobody is taken for somebody else.
fn followed<E: From<Error>>(
    recording: &mut Recording,
    fps: f64,
    mut watch: impl FnMut() -> Result<(), E>,
) -> Result<Vec<SightedRun>, E> {
    let cameras = recording.cameras().to_vec();
    let mut runs = vec![];
    for window in windows(&recording.frames(), fps) {
        let mut frames = vec![];
        for number in window.clone() {
            watch()?;
            frames.push((number, recording.people(number).map_err(|error| E::from(error.into()))?));
        }
        let are_several = frames.iter().any(|(_, views)| views.iter().any(|people| people.len() > 1));
        if are_several {
            let config = association::Config::default();
            let roll = Roll::call(recording, window, fps, &config, |_| Ok::<(), sinew::Error>(()));
            let roll = roll.map_err(|error| E::from(error.into()))?;
            runs.extend((0..roll.people.len()).map(|person| seen(&roll, person, &frames)));
        } else {
            runs.push(alone(&cameras, frames));
        }
    }
    Ok(runs)
}

/// The one person of some frames.
fn alone(cameras: &[Camera], frames: Vec<(u64, Vec<Vec<Person>>)>) -> SightedRun {
    let mut following = Following::default();
    let found = frames.into_iter().map(|(number, people)| {
        (number, follow(&mut following, cameras, &people, None, &association::Config::default()))
    });
    found.filter(|(_, found)| found.is_present()).map(|(number, found)| (number, found.people)).collect()
}

/// Clocks, and how badly cameras agree: the scatter of keypoints about where the others see them, over how many agree at all.
fn estimated(cameras: &[Camera], late: &[ClockLag], runs: &[SightedRun], fps: f64) -> Option<(Vec<CameraClock>, f64)> {
    let all: Vec<&Sighted> = runs.iter().flatten().map(|(_, sighted)| sighted).collect();
    let stride = all.len().div_ceil(OFFSET_FRAMES).max(1);
    let some: Vec<Sighted> = all.into_iter().step_by(stride).cloned().collect();
    if some.is_empty() {
        return None;
    }
    let config = offsets::Config::default();
    let noise = offsets::estimate(cameras, &some, &config);
    let runs: Vec<&[(u64, Sighted)]> = runs.iter().map(Vec::as_slice).collect();
    let taken: Vec<f64> = late.iter().map(|late| late.frames).collect();
    let search = LagSearch { fps, offsets: config, drifts: true };
    let clocks = camera_clocks((cameras, &taken), &runs, &search)?;
    let seen: f64 = noise.iter().map(|noise| noise.residuals as f64).sum();
    let scatter =
        noise.iter().filter(|noise| noise.sigma_px.is_finite()).map(|noise| noise.sigma_px.powi(2)).sum::<f64>();
    Some((clocks, (scatter / cameras.len() as f64).sqrt() / seen.max(1.0)))
}

/// The clock of a camera that was read with the lag `late`, beyond which `clock` is left; unknown where it is more than `most` from what was declared.
fn clock_of(camera: &Camera, late: ClockLag, (declared, most): (ClockLag, f64), clock: &CameraClock) -> FoundClock {
    let name = camera.name.clone();
    if !is_known(clock) || (clock.lag.frames - declared.frames).abs() > most {
        return FoundClock { camera: name, lag: None, drift_ppm: None, declared };
    }
    let middle = clock.lag.frames + 1e-6 * late.ppm * clock.middle;
    let lag = CameraLag { frames: middle, sd: clock.lag.sd };
    let ppm = late.ppm + 1e6 * clock.drift[0];
    let drifts = clock.drift[1] > 0.0;
    let declared = match drifts {
        false => ClockLag { frames: clock.lag.rounded(), ppm: late.ppm },
        true => {
            let ppm = (10.0 * ppm).round() / 10.0;
            ClockLag { frames: (100.0 * (middle - 1e-6 * ppm * clock.middle)).round() / 100.0, ppm }
        }
    };
    let drift_ppm = drifts.then_some([ppm, 1e6 * clock.drift[1]]);
    FoundClock { camera: name, lag: Some(lag), drift_ppm, declared }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_names_cameras_that_are_not_in_step() {
        let clock = |camera: &str, declared| FoundClock { camera: camera.into(), lag: None, drift_ppm: None, declared };
        let drifting = ClockLag { frames: -1.25, ppm: 80.0 };
        let cameras = vec![clock("a", ClockLag::default()), clock("b", ClockLag::whole(2)), clock("c", drifting)];
        let found = FoundClocks { cameras, frames: 1, ..FoundClocks::default() };
        assert_eq!(found.setting().as_deref(), Some("b=2,c=-1.25+80ppm"));
        assert_eq!(FoundClocks::default().setting(), None);
    }

    /// A camera that is 3 frames late in frame 1000, and falls behind by 100 in a million, was 2.9 frames late in frame 0; what is declared says so of frame 1000.
    #[test]
    fn a_lag_is_declared_for_the_first_frame() {
        let camera = Camera::look_at("C1", [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let clock = CameraClock { lag: CameraLag { frames: 3.0, sd: 0.1 }, drift: [1e-4, 1e-6], middle: 1000.0 };
        let found = clock_of(&camera, ClockLag::whole(3), (ClockLag::default(), 10.0), &clock);
        assert!((found.declared.frames - 2.9).abs() < 1e-9 && (found.declared.ppm - 100.0).abs() < 1e-9, "{found:?}");
        assert!(found.lag.is_some_and(|lag| (lag.frames - 3.0).abs() < 1e-9), "{found:?}");
        // It shows frame 1000 in its own frame 1003.
        let shown_at = 1000.0 + found.declared.frames + 1e-6 * found.declared.ppm * 1000.0;
        assert!((shown_at - 1003.0).abs() < 1e-9, "{shown_at}");
    }
}
