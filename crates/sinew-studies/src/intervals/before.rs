//! Runs as they were before what lasts was in the intervals.
//!
//! Their set-up has no table of it, and finds offsets, noise and sizes without.

use super::protocol::LAYOUT;
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use sinew::config::settings::Settings;
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::setup::Setup;
use sinew_tests::evaluation;
use std::path::Path;

/// Where the keypoints of a run are.
pub(super) struct Input<'a> {
    pub(super) calibration: &'a Path,
    pub(super) keypoints: &'a Path,
    /// Names of the cameras that are used.
    pub(super) cameras: &'a [&'a str],
    pub(super) fps: f64,
}

/// Tracks into a folder, with those flags beside the set-up, and gives the set-up.
pub(super) fn track(program: &Program, input: &Input<'_>, flags: &[String], folder: &Path) -> Outcome<Setup> {
    let options = RecordingOptions {
        layout: Some(LAYOUT.into()),
        cameras: Some(input.cameras.iter().map(|name| (*name).to_owned()).collect()),
        ..RecordingOptions::default()
    };
    let mut recording = Recording::open(input.calibration, input.keypoints, &options)?;
    let (frames, settings) = (recording.frames(), Settings { fps: input.fps, ..Settings::default() });
    let setup = evaluation::set_up(&mut recording, frames, &settings, |_| ())?;
    let path = folder.with_extension("setup.toml");
    std::fs::write(&path, toml::to_string(&setup)?)?;
    let given = ["--setup".to_owned(), shown(&path)];
    program.track(&[flags, given.as_slice()].concat(), folder)?;
    std::fs::remove_file(&path)?;
    Ok(setup)
}
