//! The beginning of a run: its set-up, or where it was stopped.
//!
//! A set-up of an earlier run is checked for whether it belongs to the recording.

use super::colours::colour_warning;
use super::inputs::hashes;
use super::level::{levelled, place_at_start};
use super::watch::{RunPhase, Watch};
use crate::config::Resolved;
use crate::config::TrackConfig;
use crate::config::common::BODY;
use crate::config::settings::Settings;
use crate::input::frame::Frame;
use crate::input::source::{FrameSource, InputHashes};
use crate::input::up_axis::axis_before_turning;
use crate::input::upright::Upright;
use crate::setup::shared_cameras::CameraInformation;
use crate::setup::{self, KnownSetup, Setup, SetupRequest, SetupWarning};
use crate::track::checkpoint::Checkpoint;
use crate::track::error::TrackError;
use crate::track::identity::{seed_of, shown};
use crate::track::step_size::tune;
use crate::{Error, bodies, files};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_input::Problems;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A run before its first frame, or where it was stopped.
pub(super) struct Begun<'a, S> {
    pub(super) source: Upright<'a, S>,
    pub(super) setup: Setup,
    pub(super) checkpoint: Checkpoint,
    /// What its own frames say of the cameras, where the set-up was made from them.
    pub(super) said_of_cameras: Option<CameraInformation>,
}

/// A run from its beginning, with a set-up of its own or of an earlier run.
pub(super) fn begun<'a, S: FrameSource>(
    source: &'a mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    config: &TrackConfig,
    settings: &Settings,
    watch: &mut Watch<'_>,
) -> Result<Begun<'a, S>, Error> {
    let mut warnings = Vec::from_iter(config.assumed_rate());
    let known = known_setup(config)?;
    let known = known.as_deref();
    if let Some(KnownSetup { setup, .. }) = known.filter(|_| resolved.is_given(BODY.key)) {
        same_body(&config.body, setup)?;
    }
    let known_setup = known.map(|known| &known.setup);
    let (mut source, up_sd_deg) = levelled(source, &setup_frames, config, known_setup, watch, &mut warnings)?;
    let (setup, setup_toml, said_of_cameras) = match known {
        Some(KnownSetup { setup, toml }) => {
            same_calibration(&mut source, config.recording.image_scale)?;
            let person = if source.shows_one() { 0 } else { setup.person };
            let is_same = person == setup.person;
            let setup = Setup { person, ..setup.clone() };
            let toml = if is_same { toml.clone() } else { setup.to_toml()? };
            (setup, toml, None)
        }
        None => {
            let seed = seed_of_frames(&mut source, setup_frames.clone(), settings.seed)?;
            let settings = &Settings { seed, ..settings.clone() };
            let (setup, said) = set_up(&mut source, setup_frames, config, settings, watch, &mut warnings)?;
            let setup = Setup { world_up: source.up().into(), world_up_sd_deg: up_sd_deg, ..setup };
            let toml = setup.to_toml()?;
            let said = CameraInformation { world_up: setup.world_up.clone(), ..said };
            (setup, toml, Some(said))
        }
    };
    warnings.extend(colour_warning(&setup, &mut source, settings)?);
    let checkpoint = Checkpoint {
        program: env!("CARGO_PKG_VERSION").into(),
        settings: resolved.numeric_settings(),
        isa: settings.isa.name().into(),
        frames: source.frames(),
        setup_toml,
        warnings,
        texts: [resolved.to_toml(), resolved.to_json().to_string(), resolved.hash()],
        ..Checkpoint::default()
    };
    Ok(Begun { source, setup, checkpoint, said_of_cameras })
}

/// A run where it was stopped: what it had read is read again, which shows whether it is the same and counts what is odd about it.
pub(super) fn resumed<'a, S: FrameSource>(
    source: &'a mut S,
    checkpoint: Checkpoint,
    resolved: &Resolved,
    settings: &Settings,
    of_settings: &InputHashes,
    folder: &Path,
    watch: &mut Watch<'_>,
) -> Result<Begun<'a, S>, Error> {
    let refused = |problem| sinew_results::Error::checkpoint(folder, problem);
    checkpoint.check_settings(&resolved.numeric_settings(), settings.isa.name()).map_err(refused)?;
    let setup = Setup::from_toml("setup.toml of the checkpoint", &checkpoint.setup_toml)?;
    let mut source = Upright::new(source, &setup.world_up);
    let first = source.frames().start;
    source.read_again(&checkpoint.read, first..first + checkpoint.done, |done, total| {
        (watch.progress)(RunPhase::Check, done, total);
        watch.check("before tracking went on; nothing was changed")
    })?;
    checkpoint.check_inputs(&hashes(&source, of_settings), &source.frames()).map_err(refused)?;
    Ok(Begun { source, setup, checkpoint, said_of_cameras: None })
}

/// Frames that are looked at to see whether a set-up of an earlier run belongs to the calibration.
pub(super) const LOOKED_AT: u64 = 60;

/// Refuses a calibration that fits the keypoints only when it is read differently; a set-up that is given skips the pass that would notice.
fn same_calibration<S: FrameSource>(source: &mut S, image_scale: f64) -> Result<(), Error> {
    let numbers = source.frames();
    let mut frames = vec![];
    for number in numbers.start..numbers.end.min(numbers.start + LOOKED_AT) {
        frames.extend(setup::alone(&source.people(number)?));
    }
    let stride = frames.len().div_ceil(8).max(1);
    let some: Vec<_> = frames.into_iter().step_by(stride).collect();
    Ok(setup::calibration_fit::check(source.cameras(), &some, image_scale)?)
}

/// Refuses a body that is not that of the set-up.
pub(super) fn same_body(asked: &str, setup: &Setup) -> Result<(), Error> {
    if bodies::to_track(asked)? == setup.body {
        return Ok(());
    }
    Err(TrackError::Body { asked: asked.into(), known: setup.body.name().to_lowercase() }.into())
}

/// The set-up of an earlier run with which a run begins, if it does.
pub(super) fn known_setup(config: &TrackConfig) -> Result<Option<Arc<KnownSetup>>, Error> {
    let Some(path) = &config.setup else { return Ok(None) };
    config.known_setup.clone().map_or_else(|| read_setup(path).map(Arc::new), Ok).map(Some)
}

/// Reads the set-up of an earlier run.
///
/// # Errors
/// A file that cannot be read, and all values that cannot be, in one message.
pub fn read_setup(path: &Path) -> Result<KnownSetup, Error> {
    let text = files::read_text(path, MAX_CONFIG_BYTES)?;
    let setup: Setup = toml::from_str(&text).map_err(|error| {
        let line = error.span().map_or(1, |span| 1 + text[..span.start].matches('\n').count());
        TrackError::SetupFile { path: path.to_owned(), line, problem: error.message().into() }
    })?;
    let problems = setup.problems();
    match problems.is_empty() {
        true => Ok(KnownSetup::new(setup)?),
        false => Err(Problems { file: path.display().to_string(), problems }.into()),
    }
}

/// The seed of the streams of a set-up: that of what the first of its frames that shows somebody shows.
fn seed_of_frames<S: FrameSource>(source: &mut S, numbers: Range<u64>, seed: u64) -> Result<u64, Error> {
    for number in numbers {
        let people = source.people(number)?;
        if let Some(identity) = shown(&Frame { people, ..Frame::default() }) {
            return Ok(seed_of(seed, identity));
        }
    }
    Ok(seed)
}

/// When a set-up is interrupted.
const IN_SET_UP: &str = "during the set-up pass; nothing was written";

fn set_up<S: FrameSource>(
    source: &mut Upright<'_, S>,
    numbers: Range<u64>,
    config: &TrackConfig,
    settings: &Settings,
    watch: &mut Watch<'_>,
    warnings: &mut Vec<String>,
) -> Result<(Setup, CameraInformation), Error> {
    let body = bodies::to_track(&config.body)?;
    let request = SetupRequest {
        body,
        person: place_at_start(config, source),
        image_scale: config.recording.image_scale,
        lag: config.recording.lag.clone(),
        lags_of_all: source.lags_of_all().map(<[_]>::to_vec),
        fps: Some(settings.fps),
        any_size: config.any_size,
        ..SetupRequest::default()
    };
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let total = numbers.end - numbers.start;
    let frames = numbers.clone().map(|number| {
        watch.check(IN_SET_UP)?;
        let people = source.people(number)?;
        (watch.progress)(RunPhase::SetUp, number - numbers.start + 1, total);
        Ok::<_, Error>((number, people))
    });
    let (mut setup, found) = setup::set_up(&cameras, &layout, &request, frames)?;
    // The tracker looks for swapped sides in all its frames.
    let tracked = source.frames();
    let reported_later = |warning: &SetupWarning| matches!(warning, SetupWarning::Swapped { first, last, .. } if tracked.contains(first) && tracked.contains(last));
    let declared = source.up().to_owned();
    let found = found.into_iter().filter(|warning| !reported_later(warning)).map(|warning| match warning {
        SetupWarning::FeetAboveHead { frames, up_axis } => {
            SetupWarning::FeetAboveHead { frames, up_axis: axis_before_turning(up_axis, &declared) }
        }
        other => other,
    });
    warnings.extend(found.map(|warning| warning.to_string()));
    watch.check(IN_SET_UP)?;
    let tree = setup.tree();
    setup.motion_sd = Some(setup::measure_motion(&setup, &tree, source, numbers.clone(), settings.fps)?);
    let shared = config.shared_cameras.as_deref().filter(|shared| shared.world_up == source.up());
    let (all, fps, seed) = (numbers.clone(), settings.fps, settings.seed);
    let mut proceed = || watch.check(IN_SET_UP);
    let said = setup::measure_lasting_with(&mut setup, source, all, (fps, seed), shared, &mut proceed)?;
    watch.check(IN_SET_UP)?;
    setup::measure_look(&mut setup, source, numbers, settings.fps, settings.compares_colours())?;
    watch.check(IN_SET_UP)?;
    let start = setup.start_frame;
    tune(&mut setup, &tree, source, start, settings)?;
    Ok((setup, said))
}
