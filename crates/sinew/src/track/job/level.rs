//! The world of a run, turned so that z points up.
//!
//! What points up is declared (`--up`, `--up-axis`), known from a set-up, or shown by the person (`--up auto`).

use super::watch::{RunPhase, Watch};
use crate::Error;
use crate::config::TrackConfig;
use crate::config::value::AUTO;
use crate::input::source::FrameSource;
use crate::input::up_axis::{Z_UP, direction_text};
use crate::input::upright::Upright;
use crate::setup::upward::{UprightPart, Upward};
use crate::setup::{self, Setup, SetupRequest};
use crate::track::error::TrackError;
use std::ops::Range;

/// Frames in which the person is looked at, evenly spaced.
const LOOKED_AT: u64 = 300;

/// What points up in the calibration's world; `None` where the person is to show it.
pub(super) fn world_up(config: &TrackConfig, setup: Option<&Setup>) -> Result<Option<String>, Error> {
    let asked = match (&config.up, &config.up_axis) {
        (Some(_), Some(_)) => return Err(TrackError::UpTwice.into()),
        (up, axis) => up.as_ref().map(|up| ("up", up)).or(axis.as_ref().map(|axis| ("up_axis", axis))),
    };
    match (asked, setup) {
        (Some((setting, asked)), Some(setup)) if *asked != setup.world_up && asked != AUTO => {
            Err(TrackError::UpAxis { setting, asked: asked.clone(), known: setup.world_up.clone() }.into())
        }
        (_, Some(setup)) => Ok(Some(setup.world_up.clone())),
        (Some((_, asked)), None) => Ok(Some(asked.clone()).filter(|asked| asked != AUTO)),
        (None, None) => Ok(Some(Z_UP.into())),
    }
}

/// The source in a level world and, where the person showed it, the standard deviation of what points up, degrees.
pub(super) fn levelled<'a, S: FrameSource>(
    source: &'a mut S,
    numbers: &Range<u64>,
    config: &TrackConfig,
    known: Option<&Setup>,
    watch: &mut Watch<'_>,
    warnings: &mut Vec<String>,
) -> Result<(Upright<'a, S>, Option<f64>), Error> {
    if let Some(up) = world_up(config, known)? {
        return Ok((Upright::new(source, &up), None));
    }
    let mut source = Upright::new(source, Z_UP);
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let request = SetupRequest {
        person: place_at_start(config, &source),
        image_scale: config.recording.image_scale,
        lag: config.recording.lag.clone(),
        ..SetupRequest::default()
    };
    let stride = (numbers.end - numbers.start).div_ceil(LOOKED_AT).max(1);
    let total = (numbers.end - numbers.start).div_ceil(stride);
    let frames =
        (0..).zip(numbers.clone().step_by(usize::try_from(stride).unwrap_or(usize::MAX))).map(|(done, number)| {
            watch.check("while up was sought; nothing was written")?;
            (watch.progress)(RunPhase::SetUp, done + 1, total);
            Ok::<_, Error>((number, source.people(number)?))
        });
    let found = setup::find_up(&cameras, &layout, &request, frames)?;
    warnings.push(said(&found));
    Ok((source.turned(&direction_text(found.direction)), Some(found.sd_deg)))
}

/// Place of the person among everybody at the start, the most complete one first.
pub(super) fn place_at_start(config: &TrackConfig, source: &impl FrameSource) -> usize {
    config.person.filter(|_| !source.shows_one()).map_or(0, |number| number.saturating_sub(1))
}

/// What was found, in words.
fn said(found: &Upward) -> String {
    let Upward { direction: [x, y, z], sd_deg, frames, part } = found;
    let part = match part {
        UprightPart::Whole => "from ankles to head",
        UprightPart::Head => "from shoulders to ears, since ankles and hips are seen in too few frames",
        UprightPart::Trunk => "from hips to shoulders, since the ankles are seen in too few frames",
        UprightPart::SeatedTrunk => "from hips to shoulders of somebody who sits; the ankles are hardly seen",
    };
    format!(
        "the world was levelled: up is ({x:.3}, {y:.3}, {z:.3}) in the calibration's world, ± {sd_deg:.1}°, by {frames} frames of the person, {part}"
    )
}
