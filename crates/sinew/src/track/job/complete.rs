//! Results that are complete: whether they belong to the run that is requested.

use super::begin::LOOKED_AT;
use super::inputs::{file_hashes, hashes};
use super::watch::{RunPhase, Watch};
use crate::Error;
use crate::config::Resolved;
use crate::config::common::SETUP;
use crate::input::source::FrameSource;
use crate::track::checkpoint::Checkpoint;
use serde_json::Value;
use sinew_results::problem::Problem;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// Reads again what a run reads: the frames of its set-up, then all that it tracks.
fn replay<S: FrameSource>(source: &mut S, set_up: Range<u64>, watch: &mut Watch<'_>) -> Result<(), Error> {
    let frames = source.frames();
    let total = (set_up.end - set_up.start) + (frames.end - frames.start);
    let mut done = 0;
    let mut next = |watch: &mut Watch<'_>| {
        watch.check("before the results were compared with the data; nothing was changed")?;
        done += 1;
        (watch.progress)(RunPhase::Check, done, total);
        Ok::<(), Error>(())
    };
    for number in set_up {
        next(watch)?;
        source.people(number)?;
    }
    for number in frames {
        next(watch)?;
        source.frame(number)?;
    }
    Ok(())
}

/// Reads all frames of a source again, and refuses a `summary.json` of other settings, another instruction set, other frames or other data.
///
/// # Errors
/// [`sinew_results::Error::Checkpoint`] with all that differs; errors of the source; [`Error::Interrupted`].
pub fn check_complete<S: FrameSource>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    folder: &Path,
    summary: &Value,
    watch: &mut Watch<'_>,
) -> Result<(), Error> {
    let refused = |problem| sinew_results::Error::checkpoint(folder, problem);
    let Some(end) = Ended::of(summary) else {
        return Err(refused(Problem::Summary).into());
    };
    let run = Checkpoint {
        settings: Resolved::numeric_settings_in(&summary["settings"]),
        isa: end.isa,
        frames: end.frames[0]..end.frames[1],
        inputs: end.input_hashes,
        ..Checkpoint::default()
    };
    let isa = resolved.instruction_set()?;
    run.check_settings(&Resolved::numeric_settings_in(&resolved.to_json()), isa.name()).map_err(refused)?;
    let frames = source.frames();
    let set_up = match resolved.of(&SETUP) {
        Some(_) => frames.start..frames.end.min(frames.start + LOOKED_AT),
        None => setup_frames,
    };
    replay(source, set_up, watch)?;
    Ok(run.check_inputs(&hashes(source, &file_hashes(resolved)?), &frames).map_err(refused)?)
}

/// What a summary says of the run that ended.
#[derive(serde::Deserialize)]
struct Ended {
    isa: String,
    frames: [u64; 2],
    input_hashes: BTreeMap<String, String>,
}

impl Ended {
    fn of(summary: &Value) -> Option<Self> {
        serde::Deserialize::deserialize(summary).ok()
    }
}
