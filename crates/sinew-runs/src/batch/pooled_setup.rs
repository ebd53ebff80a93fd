//! One set-up for all trials of a subject in a session.
//!
//! Sizes, cameras, biases of the detector and noise are the same in all of them. It is made from the trials' frames, one trial after the other, by the first who needs it. Whoever makes it makes the same bytes: shards need no lock for it.

use super::plan::Task;
use crate::Error;
use crate::listener::{Listener, PassCounter};
use crate::settings::reading;
use sinew::input::footage::Footage;
use sinew::input::one_after_another::OneAfterAnother;
use sinew::observe::association;
use sinew::results::write_whole;
use sinew::track::job::{self, Watch};
use std::path::{Path, PathBuf};

/// Folder of the set-ups in a study.
const POOLED: &str = "setups";

/// The set-up of a pool, made if it is not there.
///
/// # Errors
/// [`Error::UnlikeTrials`]; errors of the recordings and the set-up; an interrupt.
pub(super) fn pooled_setup(
    study: &Path,
    root: &Path,
    pool: &str,
    members: &[&Task],
    listener: &dyn Listener,
) -> Result<PathBuf, Error> {
    // What it was made from is in its name: another plan has another.
    let hash = members.first().map_or("", |task| task.hash.as_str());
    let path = study.join(POOLED).join(format!("{pool}-{hash}.toml"));
    if path.is_file() {
        return Ok(path);
    }
    let mut recordings = vec![];
    for task in members {
        let config = task.as_trial().settings(root, &[])?.track();
        recordings.push(Footage::open(&config.files(&crate::calibration(&config)?), &reading(&config))?);
    }
    let first = members.first().map_or(Ok(Default::default()), |task| task.as_trial().settings(root, &[]))?;
    let fps = first.track().settings()?.fps;
    // Long enough for a person to count as lost, and to be looked for anywhere.
    let gap = (association::Config::default().lost_frames as u64 + 1).max((0.5 * fps).ceil() as u64);
    let mut source =
        OneAfterAnother::new(recordings, gap).ok_or_else(|| Error::UnlikeTrials { pool: pool.to_owned() })?;
    let mut counter = PassCounter::new(listener);
    let stop = listener.stop();
    let mut at = |pass, done, total| counter.at(pass, done, total);
    let (setup, warnings) = job::set_up(&mut source, &first, &mut Watch { progress: &mut at, stop: &stop })?;
    let said = |warning: &String| listener.warning(&format!("{pool}: {warning}"));
    warnings.iter().for_each(said);
    let folder = study.join(POOLED);
    std::fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
    write_whole(&path, setup.as_bytes())?;
    Ok(path)
}
