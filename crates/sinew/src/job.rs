//! A whole run: set-up, tracking, smoothing, result folder; what `sinew track` and `sinew demo` have in common.
//!
//! ```text
//! frames ──▶ set-up ──▶ setup.toml          (or a set-up of an earlier run)
//!    └─────▶ tracker ──▶ result folder      (through a spool on disk and a backward pass with `smooth`)
//! ```
//!
//! An interrupt ends the run after the frame at hand; what was done is written and marked incomplete.

use crate::config::{Resolved, TrackConfig};
use crate::estimate::{Carried, FrameEstimate, Kind, RunInfo};
use crate::files;
use crate::output::{Claim, Ending, ResultFolder, Summary, Texts};
use crate::pipeline::{self, FrameSource, Method, Pipeline, Settings, Spool, Upright};
use crate::setup::{self, Request, Setup, Warning};
use crate::{Error, bodies};
use sinew_core::lanes::Isa;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pass {
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

/// Tracks the frames of a source into a claimed folder.
///
/// `warn` gives the warnings of the source when all is read.
///
/// # Errors
/// Those of the source, the set-up, the tracker and the disk.
pub fn track<S: FrameSource>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    watch: &mut Watch<'_>,
    inputs: impl FnOnce(&S) -> (Vec<String>, BTreeMap<String, String>),
) -> Result<Outcome, Error> {
    let config = resolved.track();
    let started = SystemTime::now();
    let clock = Instant::now();
    let mut warnings = Vec::new();
    let mut settings = settings(&config)?;
    if config.fps.is_none() {
        warnings.push(format!("no frame rate given; {DEFAULT_FPS} frames per second assumed (`--fps`)"));
    }
    settings.fps = config.fps.unwrap_or(DEFAULT_FPS);

    let settings_files = file_hashes(resolved)?;
    let known = config.setup.as_deref().map(read_setup).transpose()?;
    if let Some(setup) = known.as_ref().filter(|_| resolved.is_given("body")) {
        same_body(&config.body, setup)?;
    }
    let up = world_up(&config, known.as_ref())?;
    let mut source = Upright::new(source, &up);
    let setup = match known {
        Some(setup) => {
            same_calibration(&mut source, config.image_scale)?;
            setup
        }
        None => {
            let setup = set_up(&mut source, setup_frames, &config, &settings, watch, &mut warnings)?;
            Setup { world_up: up, ..setup }
        }
    };
    let setup_s = clock.elapsed().as_secs_f64();
    let tree = setup.tree();
    let cameras = source.cameras().to_vec();
    let mut pipeline = Pipeline::new(&setup, &tree, &cameras, source.layout(), settings.clone())?;
    let frames = source.frames();
    let kind = if config.smooth { Kind::Smoothed } else { Kind::Filtered };
    let carried = pipeline.carried();
    let info = RunInfo {
        method: settings.method.name().into(),
        kind,
        body: tree.clone(),
        fps: settings.fps,
        first_frame: frames.start,
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
        setup_toml: setup.to_toml()?,
    };
    let mut spool = match config.smooth {
        true => {
            let file = claim.folder().join("smooth.partial");
            Some(Spool::create(&file, tree.dof(), info.cameras.len(), info.keypoints.len())?)
        }
        false => None,
    };
    let texts = Texts { config_toml: resolved.to_toml(), settings: resolved.to_json(), settings_hash: resolved.hash() };
    let mut results = ResultFolder::create(claim, info, texts)?;

    let total = frames.end - frames.start;
    let mut done = 0;
    let tracked = pipeline.track(&mut source, frames, |estimate: FrameEstimate, posterior| {
        match &mut spool {
            Some(spool) => spool.append(&estimate, &pipeline::moments(posterior, settings.isa))?,
            None => results.append(&estimate)?,
        }
        done += 1;
        (watch.progress)(Pass::Track, done, total);
        Ok(go_on(watch.stop))
    });
    // What was done before a failure is written, too, unless the disk is what failed.
    let tracked = match tracked {
        Err(error) if done == 0 || matches!(error, Error::Io { .. }) => return Err(error),
        other => other,
    };
    let track_s = clock.elapsed().as_secs_f64() - setup_s;
    if let Some(spool) = &mut spool {
        let mut smoothed = 0;
        pipeline::smooth(spool, &pipeline, &tree, |estimate| {
            results.append(&estimate)?;
            smoothed += 1;
            (watch.progress)(Pass::Smooth, smoothed, done);
            Ok(ControlFlow::Continue(()))
        })?;
    }
    drop(spool);
    let (source_warnings, mut input_hashes) = inputs(source.source());
    input_hashes.extend(settings_files);
    warnings.splice(0..0, source_warnings);
    warnings.extend(pipeline.warnings());
    let mut told = BTreeSet::new();
    warnings.retain(|warning| told.insert(warning.clone()));
    let wall_s = clock.elapsed().as_secs_f64();
    let timings = serde_json::json!({
        "started_unix_s": started.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs()),
        "wall_s": wall_s,
        "set_up_s": setup_s,
        "track_s": track_s,
        "frames_per_second": done as f64 / track_s,
        "threads": rayon::current_num_threads(),
    });
    let ending = Ending {
        complete: done == total && tracked.is_ok(),
        warnings,
        input_hashes,
        limits: config.limits,
        timings: timings.as_object().cloned().unwrap_or_default(),
    };
    let summary = results.finish(&ending)?;
    tracked?;
    Ok(Outcome { summary, ms_per_frame: 1e3 * track_s / done.max(1) as f64 })
}

/// Hashes of the files that settings name: set-up, body and layout; the calibration is the source's.
fn file_hashes(resolved: &Resolved) -> Result<BTreeMap<String, String>, Error> {
    let mut hashes = BTreeMap::new();
    for (key, path) in resolved.files() {
        let text = files::read_text(&path, MAX_CONFIG_BYTES)?;
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
        draws: config.draws,
        ..Settings::default()
    })
}

/// The axis of the calibration's world that points up.
fn world_up(config: &TrackConfig, setup: Option<&Setup>) -> Result<String, Error> {
    match (&config.up_axis, setup) {
        (Some(asked), Some(setup)) if *asked != setup.world_up => Err(Error::Usage {
            message: format!("`up_axis` is {asked}; the set-up was made with {}", setup.world_up),
            help: "leave `up_axis` out: the set-up knows it".into(),
        }),
        (_, Some(setup)) => Ok(setup.world_up.clone()),
        (asked, None) => Ok(asked.clone().unwrap_or_else(|| setup::Z_UP.into())),
    }
}

/// Frames that are looked at to tell whether a set-up of an earlier run belongs to the calibration.
const LOOKED_AT: u64 = 60;

/// Refuses a calibration that fits the keypoints only when it is read differently; a set-up that is given skips the pass that would tell.
fn same_calibration<S: FrameSource>(source: &mut S, image_scale: f64) -> Result<(), Error> {
    let numbers = source.frames();
    let mut frames = vec![];
    for number in numbers.start..numbers.end.min(numbers.start + LOOKED_AT) {
        frames.extend(setup::alone(&source.people(number)?));
    }
    let stride = frames.len().div_ceil(8).max(1);
    let some: Vec<_> = frames.into_iter().step_by(stride).collect();
    setup::calibration_fit::check(source.cameras(), &some, image_scale)
}

/// Refuses a body that is not that of the set-up.
fn same_body(asked: &str, setup: &Setup) -> Result<(), Error> {
    if bodies::to_track(asked)? == setup.body {
        return Ok(());
    }
    Err(Error::Usage {
        message: format!("`body` is {asked}; the set-up was made with {}", setup.body.name().to_lowercase()),
        help: "leave `--body` out: the set-up knows it; or leave `--setup` out".into(),
    })
}

fn read_setup(path: &Path) -> Result<Setup, Error> {
    let text = files::read_text(path, MAX_CONFIG_BYTES)?;
    let setup: Setup = toml::from_str(&text).map_err(|error| {
        let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
        Error::Input {
            message: format!("{}:{line}: {}", path.display(), error.message()),
            help: Some("give `--setup` the setup.toml of a result folder of this version, or leave it out".into()),
        }
    })?;
    let problems = setup.problems();
    if problems.is_empty() { Ok(setup) } else { Err(Error::Config { file: path.display().to_string(), problems }) }
}

fn set_up<S: FrameSource>(
    source: &mut S,
    numbers: Range<u64>,
    config: &TrackConfig,
    settings: &Settings,
    watch: &mut Watch<'_>,
    warnings: &mut Vec<String>,
) -> Result<Setup, Error> {
    let body = bodies::to_track(&config.body)?;
    let request = Request {
        body,
        person: config.person.unwrap_or_default(),
        image_scale: config.image_scale,
        ..Request::default()
    };
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let total = numbers.end - numbers.start;
    let frames = numbers.clone().map(|number| {
        if watch.stop.load(Ordering::SeqCst) {
            return Err(Error::Interrupted);
        }
        let people = source.people(number)?;
        (watch.progress)(Pass::SetUp, number - numbers.start + 1, total);
        Ok((number, people))
    });
    let (mut setup, found) = setup::set_up(&cameras, &layout, &request, frames)?;
    // The tracker looks for swapped sides in all its frames.
    let tracked = source.frames();
    let told_later = |warning: &Warning| matches!(warning, Warning::Swapped { first, last, .. } if tracked.contains(first) && tracked.contains(last));
    let declared = config.up_axis.as_deref().unwrap_or(setup::Z_UP);
    let found = found.into_iter().filter(|warning| !told_later(warning)).map(|warning| match warning {
        Warning::FeetAboveHead { frames, up_axis } => {
            Warning::FeetAboveHead { frames, up_axis: setup::checks::axis_before_turning(up_axis, declared) }
        }
        other => other,
    });
    warnings.extend(found.map(|warning| warning.to_string()));
    let tree = setup.tree();
    setup.motion_sd = Some(pipeline::measure_motion(&setup, &tree, source, numbers, settings.fps)?);
    if settings.method == Method::Hmc {
        let start = setup.start_frame;
        pipeline::tune(&mut setup, &tree, source, start, settings)?;
    }
    Ok(setup)
}
