//! What runs of one person and of several have in common.

use super::args::TrackArgs;
use super::error::Error;
use super::report::Report;
use super::report_page;
use sinew::config::TrackConfig;
use sinew::input::footage::Footage;
use sinew::input::one_person::OnePerson;
use sinew::input::source::FrameSource;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// How a run that ended early is continued.
pub(crate) const RESUME: &str = "the same command with `--resume` continues from there";

/// Frames of a recording for the set-up pass.
pub(crate) fn setup_frames(config: &TrackConfig, recording: &Footage) -> Result<Range<u64>, Error> {
    let available = recording.available();
    let Some(asked) = config.setup_frames.clone() else { return Ok(available) };
    let cut = asked.start.max(available.start)..asked.end.min(available.end);
    if cut.is_empty() { Err(Error::SetupFrames { asked, available }) } else { Ok(cut) }
}

/// Frames for the set-up that show a person, or all of his where there are none.
pub(crate) fn within(asked: &Range<u64>, frames: &Range<u64>) -> Range<u64> {
    let both = asked.start.max(frames.start)..asked.end.min(frames.end);
    if both.is_empty() { frames.clone() } else { both }
}

/// Frames that come from a recording, perhaps with one of its people alone.
pub(crate) trait FromFootage: FrameSource + Send {
    /// The recording.
    fn footage(&self) -> &Footage;
}

impl FromFootage for Footage {
    fn footage(&self) -> &Footage {
        self
    }
}

impl FromFootage for OnePerson<'_, Footage> {
    fn footage(&self) -> &Footage {
        self.source
    }
}

/// Writes the page of the results, if it is wanted.
pub(crate) fn show(args: &TrackArgs, calibration: &Path, out: &Path, report: &Report) -> Result<(), Error> {
    if args.report {
        let page = out.join(report_page::PAGE);
        report_page::write(out, &report_page::with_calibration(calibration), &page, report)?;
        report.note(&format!("a page that shows the results: {}", report_page::opening(&page)));
    }
    Ok(())
}

/// The calibration, if there is something to track with it; else what to try.
pub(crate) fn calibration(config: &TrackConfig) -> Result<PathBuf, Error> {
    let observation = config.keypoints.is_some() || config.silhouettes.is_some();
    let calibration = config.calibration.clone().filter(|_| observation);
    calibration.ok_or(Error::NothingToTrack { calibration: config.calibration.is_some(), observation })
}
