//! What runs of one person and of several have in common.

use crate::Error;
use crate::config::TrackConfig;
use crate::input::flag::flag;
use crate::input::footage::{Footage, Init};
use crate::input::roll::Roll;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// How a run that ended early is continued.
#[must_use]
pub fn how_to_resume() -> String {
    format!("the same command with {} continues from there", flag("resume"))
}

/// The recording of a run, of which the one who was `chosen` is shown alone, and the frames for its set-up: those asked for that also show them; all that show them where the two have none in common.
pub(crate) fn opened<'a>(
    config: &TrackConfig,
    calibration: &Path,
    chosen: Option<(&'a Roll, usize)>,
) -> Result<(Footage<'a>, Range<u64>), Error> {
    let recording = config.footage(calibration)?.showing(chosen);
    let asked = setup_frames(config, &recording)?;
    let Some((roll, person)) = chosen else { return Ok((recording, asked)) };
    let shown = &roll.people[person].frames;
    let both = asked.start.max(shown.start)..asked.end.min(shown.end);
    Ok((recording, if both.is_empty() { shown.clone() } else { both }))
}

/// Frames of a recording for the set-up pass.
pub(crate) fn setup_frames(config: &TrackConfig, recording: &Footage<'_>) -> Result<Range<u64>, Error> {
    let available = recording.available();
    let Some(asked) = config.setup_frames.clone() else { return Ok(available) };
    let cut = asked.start.max(available.start)..asked.end.min(available.end);
    if cut.is_empty() { Err(Error::SetupFrames { asked, available }) } else { Ok(cut) }
}

/// The calibration of a run, where there is something to track with it.
///
/// # Errors
/// [`Error::NothingToTrack`] with what to try.
pub fn calibration(config: &TrackConfig) -> Result<PathBuf, Error> {
    if config.given.is_some() {
        // Nothing is read from it.
        return Ok(PathBuf::new());
    }
    let observation = config.keypoints.is_some() || config.silhouettes.is_some();
    let calibration = config.calibration.clone().filter(|_| observation);
    calibration.ok_or(Error::NothingToTrack { calibration: config.calibration.is_some(), observation })
}

/// Files and folders that a run reads, with the `file` of its settings, if one was named.
#[must_use]
pub fn read_from(config: &TrackConfig, calibration: &Path, file: Option<&Path>) -> Vec<PathBuf> {
    let mut read_from = if config.given.is_some() { vec![] } else { vec![calibration.to_owned()] };
    read_from.extend([&config.keypoints, &config.silhouettes, &config.images].into_iter().flatten().cloned());
    if let Some(Init::Points(path)) = &config.init {
        read_from.push(path.clone());
    }
    read_from.extend([&config.setup, &config.standing].into_iter().flatten().cloned());
    read_from.extend(file.map(PathBuf::from));
    read_from.extend(Some(PathBuf::from(&config.body)).filter(|body| body.is_file()));
    read_from
}
