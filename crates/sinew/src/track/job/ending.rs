//! The end of a run: warnings, timings, the summary.

use super::inputs::hashes;
use crate::Error;
use crate::config::TrackConfig;
use crate::input::source::{FrameSource, InputHashes};
use crate::setup::{MeasuredColours, MeasuredGirth};
use crate::track::pipeline::Pipeline;
use sinew_body::KinematicTree;
use sinew_results::{Ending, ResultFolder, Summary};
use std::collections::BTreeSet;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What stands in `summary.json`.
    pub summary: Summary,
    /// Wall time of the tracking pass per frame, milliseconds.
    pub ms_per_frame: f64,
    /// The body that was tracked.
    pub body: KinematicTree,
    /// Girths of the subject, where masks show them.
    pub girth: Option<MeasuredGirth>,
    /// Colours of the subject's parts, where they were compared.
    pub colours: Option<MeasuredColours>,
}

/// Wall times of a run.
pub(super) struct Clock {
    started: SystemTime,
    since: Instant,
    set_up: Duration,
    track: Duration,
}

impl Clock {
    pub(super) fn started() -> Self {
        let zero = Duration::ZERO;
        Self { started: SystemTime::now(), since: Instant::now(), set_up: zero, track: zero }
    }

    pub(super) fn set_up_is_done(&mut self) {
        self.set_up = self.since.elapsed();
    }

    pub(super) fn tracking_is_done(&mut self) {
        self.track = self.since.elapsed() - self.set_up;
    }

    /// Wall time of `frames` frames, milliseconds a frame.
    pub(super) fn ms_per_frame(&self, frames: u64) -> f64 {
        1e3 * self.track.as_secs_f64() / frames.max(1) as f64
    }

    /// `timings.json`, for `frames` frames of this run after those before it was resumed.
    pub(super) fn timings(&self, before: u64, frames: u64) -> serde_json::Map<String, serde_json::Value> {
        let timings = serde_json::json!({
            "started_unix_s": self.started.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
            "wall_s": self.since.elapsed().as_secs_f64(),
            "set_up_s": self.set_up.as_secs_f64(),
            "track_s": self.track.as_secs_f64(),
            "frames_before": before,
            "frames_per_second": frames as f64 / self.track.as_secs_f64(),
            "threads": rayon::current_num_threads(),
        });
        timings.as_object().cloned().unwrap_or_default()
    }
}

/// What a run came to, before its folder is finished.
pub(super) struct Finish {
    /// Whether all is there.
    pub(super) complete: bool,
    /// Frames that were left out.
    pub(super) skipped: u64,
    /// Warnings that neither source nor tracker repeats.
    pub(super) warnings: Vec<String>,
    /// Frames tracked before this run was resumed.
    pub(super) before: u64,
    /// Frames tracked since.
    pub(super) done: u64,
}

impl Finish {
    /// Finishes the folder.
    pub(super) fn summary<S: FrameSource>(
        self,
        results: ResultFolder,
        pipeline: &Pipeline,
        of_settings: &InputHashes,
        source: &S,
        config: &TrackConfig,
        clock: &Clock,
    ) -> Result<Summary, Error> {
        let warnings = source.warnings().into_iter().chain(self.warnings).chain(pipeline.warnings());
        Ok(results.finish(&Ending {
            complete: self.complete,
            skipped_frames: self.skipped,
            identity: pipeline.identity().map(|identity| format!("{identity:016x}")),
            warnings: distinct(warnings),
            input_hashes: hashes(source, of_settings),
            coverage: pipeline.coverage().to_vec(),
            limits: config.limits,
            timings: clock.timings(self.before, self.done),
        })?)
    }
}

/// Each warning once, in the order of the first.
fn distinct(warnings: impl IntoIterator<Item = String>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    warnings.into_iter().filter(|warning| seen.insert(warning.clone())).collect()
}
