//! Results that are complete: whether they are those of the run that is asked for.

use super::super::checkpoint::Checkpoint;
use super::{Pass, Watch, begin, file_hashes, go_on, settings};
use crate::Error;
use crate::config::Resolved;
use crate::input::source::FrameSource;
use crate::results::problem::Problem;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// Reads all that a run read of a source again, and refuses a `summary.json` of other settings, another instruction set, other frames or other data; `inputs` gives the hashes of what was read of the source so far.
///
/// # Errors
/// [`Error::Checkpoint`] with all that differs; those of the source; [`Error::Interrupted`].
pub fn check_complete<S: FrameSource>(
    source: &mut S,
    setup_frames: Range<u64>,
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
    let config = resolved.track();
    let isa = settings(&config)?.isa;
    run.check_settings(&Resolved::of_numbers_told(&resolved.to_json()), isa.name()).map_err(refused)?;
    let frames = source.frames();
    let before = begin::frames_before_tracking(&config, setup_frames, &frames);
    read_as_tracked(source, before, |done, total| {
        (watch.progress)(Pass::Check, done, total);
        match go_on(watch.stop).is_break() {
            true => Err(Error::Interrupted("before the results were compared with the data; nothing was changed")),
            false => Ok(()),
        }
    })?;
    let mut hashes = inputs(source);
    hashes.extend(file_hashes(resolved)?);
    run.check_inputs(&hashes, &frames).map_err(refused)
}

/// Reads what a run reads: people of the frames `before` tracking, then people and images of the tracked frames, as far as tracking looks at them. `each` gets the number of
/// frames read so far and in all, before each of them.
fn read_as_tracked<S: FrameSource>(
    source: &mut S,
    before: Range<u64>,
    mut each: impl FnMut(u64, u64) -> Result<(), Error>,
) -> Result<(), Error> {
    let tracked = source.frames();
    let later = tracked.clone().filter(|number| !before.contains(number)).count() as u64;
    let total = before.end.saturating_sub(before.start) + later;
    let mut done = 0;
    for number in before.clone() {
        done += 1;
        each(done, total)?;
        source.people(number)?;
    }
    source.begin_tracking();
    let (reads_people, reads_images) = (source.reads_people(), source.image_cameras().is_some());
    for number in tracked {
        let is_new = !before.contains(&number);
        done += u64::from(is_new);
        each(done, total)?;
        if reads_people && is_new {
            source.people(number)?;
        }
        if reads_images {
            source.images(number)?;
        }
    }
    Ok(())
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
