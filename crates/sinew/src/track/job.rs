//! A whole run: set-up, tracking, smoothing, result folder; what `sinew track` and `sinew demo` have in common.
//!
//! ```text
//! frames ──▶ set-up ──▶ setup.toml          (or a set-up of an earlier run)
//!    └─────▶ tracker ──▶ result folder      (through a spool on disk and a backward pass with `smooth`)
//! ```
//!
//! An interrupt ends the run after the frame at hand; what was done is written and marked incomplete. A checkpoint ([`crate::track::checkpoint`]) is written before the first frame, every so many seconds and at an interrupt; from it a run goes
//! on to the same bytes, whatever stopped it: the set-up is that of the checkpoint, and what was read of the source is read again, which tells whether it is the same and counts what is odd about it.

mod begin;
mod complete;

pub use complete::check_complete;

use super::checkpoint::{self, Checkpoint};
use super::{self as pipeline, Pipeline, Settings, Spool};
use crate::config::{Resolved, TrackConfig};
use crate::input::source::FrameSource;
use crate::input::upright::Upright;
use crate::results::estimate::{Carried, FrameEstimate, Kind, RunInfo};
use crate::results::{Claim, Ending, ResultFolder, Summary, Texts};
use crate::setup::Setup;
use crate::{Error, files};
use sinew_body::KinematicTree;
use sinew_core::lanes::Isa;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_observe::Camera;
use sinew_samplers::annealed_search;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
    /// Frames are read again, to see that they are those of the run that was stopped.
    Check,
    /// Frames are read for the set-up.
    SetUp,
    /// Frames are tracked.
    Track,
    /// Frames are smoothed.
    Smooth,
}

/// Who looks on.
pub struct Watch<'a> {
    /// Told a pass, the frames done and all of them.
    pub progress: &'a mut dyn FnMut(Pass, u64, u64),
    /// Set to end after the frame at hand.
    pub stop: &'a AtomicBool,
}

/// How a run ended.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What stands in `summary.json`.
    pub summary: Summary,
    /// Wall time of the tracking pass per frame, milliseconds.
    pub ms_per_frame: f64,
}

/// Rate taken where none is given.
pub const DEFAULT_FPS: f64 = 30.0;

/// Tracks the frames of a source into a claimed folder, from the first on or from where a run was stopped.
///
/// `inputs` gives the warnings of the source and the hashes of what was read of it so far.
///
/// # Errors
/// Those of the source, the set-up, the tracker and the disk; [`Error::Checkpoint`] where the run that was stopped is another one.
pub fn track<S: FrameSource>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    watch: &mut Watch<'_>,
    inputs: impl Fn(&S) -> (Vec<String>, BTreeMap<String, String>),
    from: Option<Checkpoint>,
) -> Result<Outcome, Error> {
    let config = resolved.track();
    let started = SystemTime::now();
    let clock = Instant::now();
    let mut settings = settings(&config)?;
    settings.fps = config.fps.unwrap_or(DEFAULT_FPS);
    let settings_files = file_hashes(resolved)?;
    let hashes = |source: &Upright<'_, S>| {
        let mut hashes = inputs(source.source()).1;
        hashes.extend(settings_files.clone());
        hashes
    };
    let folder = claim.folder().to_owned();
    let refused = |problem| Error::checkpoint(&folder, problem);

    let (mut source, setup, from) = match from {
        Some(from) => {
            from.check_settings(&resolved.of_numbers(), settings.isa.name()).map_err(refused)?;
            let setup = Setup::from_toml("setup.toml of the checkpoint", &from.setup_toml)?;
            let mut source = Upright::new(source, &setup.world_up);
            source.read_again(&from.read, |done, total| {
                (watch.progress)(Pass::Check, done, total);
                match go_on(watch.stop) {
                    ControlFlow::Continue(()) => Ok(()),
                    ControlFlow::Break(()) => Err(Error::Interrupted("before tracking went on; nothing was changed")),
                }
            })?;
            if source.image_cameras().is_some() {
                let first = source.frames().start;
                (first..first + from.done).try_for_each(|number| source.images(number).map(drop))?;
            }
            from.check_inputs(&hashes(&source), &source.frames()).map_err(refused)?;
            (source, setup, from)
        }
        None => {
            let mut warnings = Vec::new();
            if config.fps.is_none() {
                warnings.push(format!("no frame rate given; {DEFAULT_FPS} frames per second assumed (`--fps`)"));
            }
            let known = config.setup.as_deref().map(begin::read_setup).transpose()?;
            if let Some(setup) = known.as_ref().filter(|_| resolved.is_given("body")) {
                begin::same_body(&config.body, setup)?;
            }
            let up = begin::world_up(&config, known.as_ref())?;
            let mut source = Upright::new(source, &up);
            let setup = match known {
                Some(setup) => {
                    begin::same_calibration(&mut source, config.image_scale)?;
                    setup
                }
                None => {
                    let setup = begin::set_up(&mut source, setup_frames, &config, &settings, watch, &mut warnings)?;
                    Setup { world_up: up, ..setup }
                }
            };
            let from = Checkpoint {
                program: env!("CARGO_PKG_VERSION").into(),
                settings: resolved.of_numbers(),
                isa: settings.isa.name().into(),
                frames: source.frames(),
                setup_toml: setup.to_toml()?,
                warnings,
                texts: [resolved.to_toml(), resolved.to_json().to_string(), resolved.hash()],
                ..Checkpoint::default()
            };
            (source, setup, from)
        }
    };
    let setup_s = clock.elapsed().as_secs_f64();
    let tree = setup.tree();
    let cameras = source.cameras().to_vec();
    source.begin_tracking();
    let image_cameras = source.image_cameras();
    let mut pipeline =
        Pipeline::with_images(&setup, &tree, &cameras, source.layout(), settings.clone(), image_cameras.as_deref())?;
    if let Some(state) = &from.pipeline {
        pipeline.restore(state).map_err(refused)?;
    }
    let frames = source.frames();
    let info = run_info(&config, &settings, &setup, &pipeline, cameras, frames.start, from.setup_toml.clone());
    if from.pipeline.is_none() {
        ResultFolder::forget(&claim)?;
    }
    let spool = match config.smooth {
        true => {
            let sizes = [tree.dof(), info.cameras.len(), info.keypoints.len()];
            Some(Spool::open(&claim, sizes, from.spool.map(|position| (from.done, position)))?)
        }
        false => None,
    };
    let results = ResultFolder::open(claim, info, texts(&from)?, from.written.as_ref())?;

    let total = frames.end - frames.start;
    let before = from.done;
    let mut keeper = Keeper { results, spool, checkpoint: from, kept: Instant::now(), cost: Duration::ZERO };
    let every = Duration::try_from_secs_f64(config.checkpoint_every).unwrap_or(Duration::MAX);
    if keeper.checkpoint.pipeline.is_none() {
        keeper.keep(&pipeline, &source, hashes(&source))?;
    }
    let tracked = loop {
        let next = frames.start + keeper.checkpoint.done;
        let tracked = pipeline.track(&mut source, next..frames.end, |estimate: FrameEstimate, posterior| {
            match &mut keeper.spool {
                Some(spool) => spool.append(&estimate, &pipeline::moments(posterior, settings.isa))?,
                None => keeper.results.append(&estimate)?,
            }
            keeper.checkpoint.done += 1;
            (watch.progress)(Pass::Track, keeper.checkpoint.done, total);
            Ok(if keeper.is_due(every) { ControlFlow::Break(()) } else { go_on(watch.stop) })
        });
        let is_last = keeper.checkpoint.done == total;
        // What was done before a failure is written, too, unless the disk is what failed.
        match tracked {
            Err(error) if keeper.checkpoint.done == before || matches!(error, Error::Io { .. }) => return Err(error),
            Err(error) => break Err(error),
            Ok(()) if is_last && keeper.spool.is_none() => break Ok(()),
            Ok(()) => keeper.keep(&pipeline, &source, hashes(&source))?,
        }
        if is_last || go_on(watch.stop).is_break() {
            break Ok(());
        }
    };
    let Keeper { mut results, spool, checkpoint, .. } = keeper;
    let done = checkpoint.done;
    let track_s = clock.elapsed().as_secs_f64() - setup_s;
    let mut written = done;
    if let Some(mut spool) = spool {
        written = smoothed(&mut spool, &mut results, &pipeline, &tree, watch, done)?;
    }
    let (mut warnings, _) = inputs(source.source());
    warnings.extend(checkpoint.warnings);
    warnings.extend(pipeline.warnings());
    let mut told = BTreeSet::new();
    warnings.retain(|warning| told.insert(warning.clone()));
    let timings = serde_json::json!({
        "started_unix_s": started.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
        "wall_s": clock.elapsed().as_secs_f64(),
        "set_up_s": setup_s,
        "track_s": track_s,
        "frames_before": before,
        "frames_per_second": (done - before) as f64 / track_s,
        "threads": rayon::current_num_threads(),
    });
    let ending = Ending {
        complete: written == total && tracked.is_ok(),
        warnings,
        input_hashes: hashes(&source),
        coverage: pipeline.coverage().to_vec(),
        limits: config.limits,
        timings: timings.as_object().cloned().unwrap_or_default(),
    };
    let summary = results.finish(&ending)?;
    tracked?;
    Ok(Outcome { summary, ms_per_frame: 1e3 * track_s / (done - before).max(1) as f64 })
}

/// The files of a run and its checkpoint.
struct Keeper {
    results: ResultFolder,
    spool: Option<Spool>,
    checkpoint: Checkpoint,
    kept: Instant,
    cost: Duration,
}

/// Checkpoints take at most this share of the time, however large they are, unless they are wanted after every frame.
const SHARE: u32 = 20;

impl Keeper {
    fn is_due(&self, every: Duration) -> bool {
        let least = if every.is_zero() { every } else { every.max(SHARE * self.cost) };
        self.kept.elapsed() >= least
    }

    /// Writes the checkpoint, behind the files that it speaks of.
    fn keep<S: FrameSource>(
        &mut self,
        pipeline: &Pipeline,
        source: &Upright<'_, S>,
        inputs: BTreeMap<String, String>,
    ) -> Result<(), Error> {
        let clock = Instant::now();
        let checkpoint = &mut self.checkpoint;
        match &mut self.spool {
            Some(spool) => checkpoint.spool = Some(spool.keep()?),
            None => checkpoint.written = Some(self.results.keep()?),
        }
        checkpoint.pipeline = Some(pipeline.save());
        checkpoint.read = source.read().to_vec();
        checkpoint.inputs = inputs;
        checkpoint::write(self.results.claim(), checkpoint)?;
        self.kept = Instant::now();
        self.cost = clock.elapsed();
        Ok(())
    }
}

/// Smooths what a spool holds; gives the number of frames written. Asked to stop in the backward pass it stops; who was asked before smooths what there is.
fn smoothed(
    spool: &mut Spool,
    results: &mut ResultFolder,
    pipeline: &Pipeline,
    tree: &KinematicTree,
    watch: &mut Watch<'_>,
    frames: u64,
) -> Result<u64, Error> {
    let asked_before = go_on(watch.stop).is_break();
    let stop = watch.stop;
    let is_stopped = || !asked_before && go_on(stop).is_break();
    let stopped = || match is_stopped() {
        true => Err(Error::Interrupted("while smoothing; all frames are tracked, `--resume` smooths them")),
        false => Ok(()),
    };
    let mut written = 0;
    pipeline::smooth(spool, pipeline, tree, stopped, |estimate| {
        results.append(&estimate)?;
        written += 1;
        (watch.progress)(Pass::Smooth, written, frames);
        Ok(if is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    Ok(written)
}

/// What is the same for all frames.
fn run_info(
    config: &TrackConfig,
    settings: &Settings,
    setup: &Setup,
    pipeline: &Pipeline,
    cameras: Vec<Camera>,
    first_frame: u64,
    setup_toml: String,
) -> RunInfo {
    let carried = pipeline.carried();
    RunInfo {
        method: settings.method.name().into(),
        kind: if config.smooth { Kind::Smoothed } else { Kind::Filtered },
        body: setup.tree(),
        fps: settings.fps,
        first_frame,
        draws: if config.smooth { settings.draws.min(pipeline::TRAJECTORIES) } else { settings.draws },
        carried: if config.smooth {
            Carried { log_evidence: carried.log_evidence, size: carried.size, ..Carried::default() }
        } else {
            carried
        },
        seed: settings.seed,
        isa: settings.isa.name().into(),
        camera_offset_px: setup.camera.iter().map(|camera| camera.offset_px).collect(),
        sigma_px: setup.camera.iter().map(|camera| camera.sigma_px).fold(0.0, f64::max),
        cameras,
        keypoints: pipeline.keypoints(),
        has_masks: config.silhouettes.is_some(),
        setup_toml,
    }
}

/// The texts of the run as it was begun.
fn texts(from: &Checkpoint) -> Result<Texts, Error> {
    let [config_toml, settings, settings_hash] = from.texts.clone();
    let settings = serde_json::from_str(&settings)
        .map_err(|error| Error::Numerical { message: format!("the settings of the run cannot be read: {error}") })?;
    Ok(Texts { config_toml, settings, settings_hash })
}

/// Hashes of the files that settings name: set-up, body and layout; the calibration is the source's.
fn file_hashes(resolved: &Resolved) -> Result<BTreeMap<String, String>, Error> {
    let mut hashes = BTreeMap::new();
    for (key, path) in resolved.files() {
        let text = files::read_text(&path, MAX_TEXT_BYTES)?;
        hashes.insert(key.to_owned(), format!("{:016x}", files::fnv(files::FNV_START, text.as_bytes())));
    }
    Ok(hashes)
}

fn go_on(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::SeqCst) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// The tracker's settings; the frame rate is settled elsewhere.
fn settings(config: &TrackConfig) -> Result<Settings, Error> {
    let isa = match &config.simd {
        None => Isa::best(),
        Some(name) => Isa::by_name(name).ok_or_else(|| {
            let available: Vec<&str> = Isa::available().into_iter().map(Isa::name).collect();
            Error::Usage {
                message: format!("this processor has no `{name}`; it has {}", available.join(", ")),
                help: "leave `--simd` out to take the best".into(),
            }
        })?,
    };
    Ok(Settings {
        method: config.method,
        seed: config.seed,
        isa,
        noise: config.noise,
        least_confidence: config.least_confidence,
        between: config.prior,
        motion_scale: config.motion_scale,
        chains: config.chains,
        updates: config.updates,
        burn_in: config.burn_in,
        jitter: config.jitter,
        particles: config.particles,
        layers: annealed_search::Config {
            layers: config.layers,
            survival: config.survival,
            adaptive: config.adaptive,
            crossover: config.crossover,
            ..annealed_search::Config::default()
        },
        fine: config.fine,
        score: config.score,
        raster: config.raster,
        draws: config.draws,
        ..Settings::default()
    })
}
