//! What comes before tracking: the set-up pass, or the set-up of an earlier run and whether it belongs to the recording.

use super::super::{self as pipeline, Method, Settings};
use super::{Pass, Watch};
use crate::config::TrackConfig;
use crate::input::source::FrameSource;
use crate::input::up_axis::{Z_UP, axis_before_turning};
use crate::setup::{self, Request, Setup, Warning};
use crate::{Error, bodies, files};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::Ordering;

/// The axis of the calibration's world that points up.
pub(super) fn world_up(config: &TrackConfig, setup: Option<&Setup>) -> Result<String, Error> {
    match (&config.up_axis, setup) {
        (Some(asked), Some(setup)) if *asked != setup.world_up => Err(Error::Usage {
            message: format!("`up_axis` is {asked}; the set-up was made with {}", setup.world_up),
            help: "leave `up_axis` out: the set-up knows it".into(),
        }),
        (_, Some(setup)) => Ok(setup.world_up.clone()),
        (asked, None) => Ok(asked.clone().unwrap_or_else(|| Z_UP.into())),
    }
}

/// Frames that are looked at to tell whether a set-up of an earlier run belongs to the calibration.
const LOOKED_AT: u64 = 60;

/// Refuses a calibration that fits the keypoints only when it is read differently; a set-up that is given skips the pass that would tell.
pub(super) fn same_calibration<S: FrameSource>(source: &mut S, image_scale: f64) -> Result<(), Error> {
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
    Err(Error::Usage {
        message: format!("`body` is {asked}; the set-up was made with {}", setup.body.name().to_lowercase()),
        help: "leave `--body` out: the set-up knows it; or leave `--setup` out".into(),
    })
}

pub(super) fn read_setup(path: &Path) -> Result<Setup, Error> {
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

pub(super) fn set_up<S: FrameSource>(
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
        lag: config.lag.clone(),
        fps: Some(settings.fps),
        any_size: config.any_size,
        ..Request::default()
    };
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let total = numbers.end - numbers.start;
    let frames = numbers.clone().map(|number| {
        if watch.stop.load(Ordering::SeqCst) {
            return Err(Error::Interrupted("during the set-up pass; nothing was written"));
        }
        let people = source.people(number)?;
        (watch.progress)(Pass::SetUp, number - numbers.start + 1, total);
        Ok((number, people))
    });
    let (mut setup, found) = setup::set_up(&cameras, &layout, &request, frames)?;
    // The tracker looks for swapped sides in all its frames.
    let tracked = source.frames();
    let told_later = |warning: &Warning| matches!(warning, Warning::Swapped { first, last, .. } if tracked.contains(first) && tracked.contains(last));
    let declared = config.up_axis.as_deref().unwrap_or(Z_UP);
    let found = found.into_iter().filter(|warning| !told_later(warning)).map(|warning| match warning {
        Warning::FeetAboveHead { frames, up_axis } => {
            Warning::FeetAboveHead { frames, up_axis: axis_before_turning(up_axis, declared) }
        }
        other => other,
    });
    warnings.extend(found.map(|warning| warning.to_string()));
    let tree = setup.tree();
    setup.motion_sd = Some(setup::measure_motion(&setup, &tree, source, numbers, settings.fps)?);
    if settings.method == Method::Hmc {
        let start = setup.start_frame;
        pipeline::tune(&mut setup, &tree, source, start, settings)?;
    }
    Ok(setup)
}
