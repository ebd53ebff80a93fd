//! Clocks of the cameras against each other.

use super::collect::Collected;
use super::warning::SetupWarning;
use sinew_formats::camera_name;
use sinew_input::lag::ClockLag;
use sinew_input::roll::Roll;
use sinew_input::source::FrameSource;
use sinew_observe::Camera;
use sinew_observe::association::Person;
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::clocks::lag_estimate::{CameraLag, LagSearch, camera_clocks};
use std::ops::Range;

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

/// What cameras show of one person in consecutive frames, with their numbers.
pub type SightedRun = Vec<(u64, Sighted)>;

/// Windows of a recording in which clocks are judged, and their seconds.
const WINDOWS: u64 = 15;
const WINDOW_S: f64 = 2.0;

/// Lags of all cameras in the runs of consecutive frames that were kept, of `fps` a second; empty where there is one camera, or too few frames.
#[must_use]
pub fn lags(cameras: &[Camera], collected: &Collected, how: (Option<f64>, offsets::Config)) -> Vec<CameraLag> {
    let window = collected.window.as_slice();
    let end = window.last().map_or(0, |(number, _)| *number);
    let after = |run: &&[(u64, Sighted)]| run.first().is_some_and(|(number, _)| *number > end);
    let later = collected.later.iter().map(Vec::as_slice).filter(after);
    let runs: Vec<&[(u64, Sighted)]> = std::iter::once(window).chain(later).collect();
    estimated(cameras, &runs, runs.iter().map(|run| run.len()).sum(), how)
}

/// Lags of all cameras as everybody shows them: one estimate, to which whoever hardly moves, or is hardly seen, adds little. `source` shows everybody on the `roll`; `watch` is called before each frame and may stop. Empty as for [`lags`].
///
/// # Errors
/// Frames that cannot be read; errors of `watch`.
pub fn lags_of_all<S: FrameSource, E: From<sinew_input::Error>>(
    source: &mut S,
    roll: &Roll,
    how: (Option<f64>, offsets::Config),
    mut watch: impl FnMut() -> Result<(), E>,
) -> Result<Vec<CameraLag>, E> {
    let cameras = source.cameras().to_vec();
    let (mut runs, mut count) = (vec![], 0);
    for window in windows(&source.frames(), how.0.unwrap_or(USUAL_FPS)) {
        let mut frames = vec![];
        for number in window {
            watch()?;
            frames.push((number, source.people(number)?));
        }
        count += frames.len();
        runs.extend((0..roll.people.len()).map(|person| seen(roll, person, &frames)));
    }
    let runs: Vec<&[(u64, Sighted)]> = runs.iter().map(Vec::as_slice).collect();
    Ok(estimated(&cameras, &runs, count, how))
}

/// Windows of two seconds in which clocks are judged, evenly spread over frames of `fps` a second; one of all frames where they would touch.
#[must_use]
pub fn windows(frames: &Range<u64>, fps: f64) -> Vec<Range<u64>> {
    evenly_spread(frames, WINDOWS, (WINDOW_S * fps).ceil() as u64)
}

/// What cameras show of one of several people in frames with everybody.
#[must_use]
pub fn seen(roll: &Roll, person: usize, frames: &[(u64, Vec<Vec<Person>>)]) -> SightedRun {
    let shown = |(number, people): &(u64, Vec<Vec<Person>>)| {
        let [own, _] = roll.parted(*number, person, people.clone());
        let views: Sighted = own.into_iter().map(|view| view.into_iter().next().unwrap_or_default()).collect();
        views.iter().any(|view| !view.is_empty()).then_some((*number, views))
    };
    frames.iter().filter_map(shown).collect()
}

fn evenly_spread(frames: &Range<u64>, count: u64, width: u64) -> Vec<Range<u64>> {
    let all = frames.end - frames.start;
    if all <= count * width {
        return vec![frames.clone()];
    }
    let last = all - width;
    let start = |k: u64| frames.start + if count > 1 { k * last / (count - 1) } else { 0 };
    (0..count).map(|k| start(k)..start(k) + width).collect()
}

fn estimated(
    cameras: &[Camera],
    runs: &[&[(u64, Sighted)]],
    frames: usize,
    (fps, offsets): (Option<f64>, offsets::Config),
) -> Vec<CameraLag> {
    if are_too_few(frames, fps) {
        return vec![];
    }
    let search = LagSearch { fps: fps.unwrap_or(USUAL_FPS), offsets, drifts: false };
    let taken = vec![0.0; cameras.len()];
    let clocks = camera_clocks((cameras, &taken), runs, &search).unwrap_or_default();
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

    #[test]
    fn windows_are_spread_from_the_first_frame_to_the_last() {
        assert_eq!(evenly_spread(&(5..300), 3, 100).first(), Some(&(5..300)));
        assert_eq!(evenly_spread(&(5..1005), 3, 100), [5..105, 455..555, 905..1005]);
        assert_eq!(evenly_spread(&(5..1005), 1, 100).first(), Some(&(5..105)));
        assert_eq!(windows(&(0..3000), 60.0).last(), Some(&(2880..3000)));
    }

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
