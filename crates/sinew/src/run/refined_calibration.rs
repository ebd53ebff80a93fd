//! `sinew track --write-calibration`: the calibration as the set-up of the run refined it.

use super::listener::Listener;
use crate::Error;
use crate::config::TrackConfig;
use crate::files::read_text;
use crate::formats::source_text::MAX_CONFIG_BYTES;
use crate::setup::Setup;
use sinew_results::Occupied;
use sinew_results::{RESULT_NAMES, write_whole};
use sinew_setup::refined_calibration::RefinedCalibration;
use std::fs;
use std::path::{Path, PathBuf};

/// Refuses, before anything is computed, a file that cannot be written at the end.
pub(crate) fn check(path: &Path, config: &TrackConfig, read_from: &[PathBuf]) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let in_results = folder == config.out;
    if in_results && RESULT_NAMES.iter().any(|name| path.ends_with(name)) {
        return Err(Error::ResultIsOutput(path.to_owned()));
    }
    if !in_results {
        fs::read_dir(folder).map_err(crate::Error::io("read", folder))?;
    }
    let is_it = |input: &&PathBuf| path.canonicalize().is_ok_and(|out| input.canonicalize().is_ok_and(|it| it == out));
    if let Some(input) = read_from.iter().find(is_it) {
        return Err(Error::InputIsOutput(input.clone()));
    }
    if path.exists() && !config.force {
        return Err(sinew_results::Error::OutputExists { path: path.to_owned(), found: Occupied::File }.into());
    }
    Ok(())
}

/// Writes the file once the results are there.
pub(crate) fn write(
    path: &Path,
    config: &TrackConfig,
    calibration: &Path,
    listener: &dyn Listener,
) -> Result<(), Error> {
    let setup = config.out.join("setup.toml");
    let setup = Setup::from_toml(&setup.display().to_string(), &read_text(&setup, MAX_CONFIG_BYTES)?)?;
    let refined = RefinedCalibration::read(calibration, &setup, config.recording.image_scale)?;
    write_whole(path, refined.to_toml().as_bytes())?;
    listener.note(&format!("the calibration as the set-up refined it is in {}", path.display()));
    if !refined.unchanged.is_empty() {
        listener.note(&format!("not in the set-up and as they were: {}", refined.unchanged.join(", ")));
    }
    Ok(())
}
