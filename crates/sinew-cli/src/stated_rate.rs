//! The frame rate that a keypoint file states, where no setting gives one.

use super::args::General;
use super::error::Error;
use super::report::Report;
use super::settings::settings;
use sinew::config::Resolved;
use sinew::input::recording::keypoint_sources::stated_rate;

/// Settings by name, as they are typed.
type Flags = Vec<(&'static str, String)>;

/// The flags with the frame rate that the times in the keypoints say, as though it had been typed.
pub(crate) fn with_stated_rate(
    flags: &[(&'static str, String)],
    general: &General,
    report: &Report,
) -> Result<(Flags, Resolved), Error> {
    let mut flags = flags.to_vec();
    let resolved = settings(&flags, general)?;
    let config = resolved.track();
    let (None, Some(keypoints)) = (config.fps, &config.keypoints) else { return Ok((flags, resolved)) };
    // What cannot be read is reported where the recording is opened.
    let Ok(Some(rate)) = stated_rate(keypoints) else { return Ok((flags, resolved)) };
    report.note(&format!("{rate} frames per second, by the times in {} (`--fps`)", keypoints.display()));
    flags.push(("fps", rate.to_string()));
    let resolved = settings(&flags, general)?;
    Ok((flags, resolved))
}
