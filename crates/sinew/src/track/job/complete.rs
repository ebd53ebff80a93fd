//! Results that are complete: whether they are those of the run that is asked for.

use super::super::checkpoint::Checkpoint;
use super::{Pass, Watch, file_hashes, go_on, settings};
use crate::Error;
use crate::config::Resolved;
use crate::input::source::FrameSource;
use crate::results::problem::Problem;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Reads all frames of a source again, and refuses a `summary.json` of other settings, another instruction set, other frames or other data; `inputs` gives the hashes of what was read of the source so far.
///
/// # Errors
/// [`Error::Checkpoint`] with all that differs; those of the source; [`Error::Interrupted`].
pub fn check_complete<S: FrameSource>(
    source: &mut S,
    resolved: &Resolved,
    folder: &Path,
    summary: &Value,
    watch: &mut Watch<'_>,
    inputs: impl Fn(&S) -> BTreeMap<String, String>,
) -> Result<(), Error> {
    let refused = |problem| Error::checkpoint(folder, problem);
    let Some(end) = Ended::of(summary) else {
        return Err(refused(Problem::Summary));
    };
    let run = Checkpoint {
        settings: Resolved::of_numbers_told(&summary["settings"]),
        isa: end.isa,
        frames: end.frames[0]..end.frames[1],
        inputs: end.input_hashes,
        ..Checkpoint::default()
    };
    let isa = settings(&resolved.track())?.isa;
    run.check_settings(&Resolved::of_numbers_told(&resolved.to_json()), isa.name()).map_err(refused)?;
    let frames = source.frames();
    let total = frames.end.saturating_sub(frames.start);
    for (number, done) in frames.clone().zip(1..) {
        if go_on(watch.stop).is_break() {
            return Err(Error::Interrupted("before the results were compared with the data; nothing was changed"));
        }
        source.people(number)?;
        (watch.progress)(Pass::Check, done, total);
    }
    let mut hashes = inputs(source);
    hashes.extend(file_hashes(resolved)?);
    run.check_inputs(&hashes, &frames).map_err(refused)
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
