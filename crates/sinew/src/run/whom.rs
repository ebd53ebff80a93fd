//! Whom a run tracks: everybody, one of several by number, or the most complete one at the start.
//!
//! People are named over the whole recording first, where two cameras or more have keypoints of it for long enough.

use super::listener::Listener;
use super::pieces::setup_frames;
use crate::Error;
use crate::config::common::People;
use crate::config::{Resolved, TrackConfig};
use crate::input::flag::{flag, flag_with};
use crate::input::footage::Footage;
use crate::input::roll::{LEAST_S, Roll};
use crate::input::source::FrameSource as _;
use crate::observe::association;
use crate::observe::cameras::offsets;
use crate::setup::clocks::lags_of_all;
use sinew_results::Claim;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::Ordering;

/// Number of frames that are searched for a second person in view.
const LOOKED_AT: usize = 60;

/// Whom a run tracks.
pub enum Whom {
    /// The most complete one at the start.
    MostComplete,
    /// One of several, by their place in the roll.
    One(Roll, usize),
    /// Several.
    Everybody(Roll),
}

/// Whom to track, and the output folder, if it was `claimed` before people were looked for.
///
/// # Errors
/// [`Error::NoSuchPerson`], [`Error::SetupFrames`]; errors of the recording and of `claimed`.
pub fn looked_for(
    resolved: &Resolved,
    calibration: &Path,
    listener: &dyn Listener,
    claimed: impl Fn() -> Result<Option<Claim>, Error>,
) -> Result<(Option<Claim>, Whom), Error> {
    let config = resolved.track();
    if config.silhouettes.is_some() || (config.people == People::One && config.person.is_none()) {
        return Ok((None, Whom::MostComplete));
    }
    let mut recording = config.footage(calibration)?;
    if let Some(why) = not_looked_for(resolved, &config, &recording)? {
        if config.person.is_none() && others_in_view(&mut recording)? {
            listener.warning(&why);
        }
        return Ok((None, Whom::MostComplete));
    }
    // Mistakes in the settings are said before what is in the folder.
    setup_frames(&config, &recording)?;
    let claim = claimed()?;
    let mut roll = called(&mut recording, config.fps(), listener)?;
    let found = roll.people.len();
    if found > 1 {
        let how = (Some(config.fps()), offsets::Config::default());
        roll.lags = lags_of_all(&mut recording, &roll, how, || go_on(listener))?;
    }
    match config.person {
        None if found > 1 => Ok((claim, Whom::Everybody(roll))),
        Some(chosen) if chosen > found && found > 0 => Err(Error::NoSuchPerson { chosen, found }),
        Some(chosen) if found > 1 => Ok((claim, Whom::One(roll, chosen - 1))),
        _ => Ok((claim, Whom::MostComplete)),
    }
}

/// Everybody over the recording.
fn called(recording: &mut Footage<'_>, fps: f64, listener: &dyn Listener) -> Result<Roll, Error> {
    let frames = recording.frames();
    let mut counter = listener.counter("who is there", "frames", frames.end - frames.start);
    let roll = Roll::call(recording, frames.clone(), fps, &association::Config::default(), |done| {
        counter.at(done);
        go_on(listener)
    })?;
    counter.at(frames.end - frames.start);
    Ok(roll)
}

fn go_on(listener: &dyn Listener) -> Result<(), Error> {
    match listener.stop().load(Ordering::Relaxed) {
        true => Err(Error::Interrupted("while people were looked for; nothing was written".into())),
        false => Ok(()),
    }
}

/// Why nobody but one person is looked for; `None` where everybody can be named.
fn not_looked_for(resolved: &Resolved, config: &TrackConfig, recording: &Footage<'_>) -> Result<Option<String>, Error> {
    let Range { start, end } = recording.frames();
    let frames = end - start;
    let kind = resolved.single_person_setting().filter(|_| config.person.is_none());
    let because = match (kind, recording.cameras().len()) {
        (Some(kind), _) => format!("{} is of one person; {} says which", flag(kind), flag_with("person", "N")),
        (None, 0 | 1) => format!(
            "with one camera nobody can find out who is who; this is the most complete one at the start ({} chooses)",
            flag("person")
        ),
        (None, _) if (frames as f64) < LEAST_S * config.fps() => format!(
            "{frames} frames are less than a quarter of a second, too few to find out who is who; this is the most \
             complete one at the start ({} chooses)",
            flag("person")
        ),
        _ => return Ok(None),
    };
    Ok(Some(format!("others are in view, too, and only one person is tracked: {because}")))
}

/// Whether a camera shows more than one person in some of evenly spaced frames.
fn others_in_view(recording: &mut Footage<'_>) -> Result<bool, Error> {
    let frames = recording.frames();
    let stride = usize::try_from(frames.end - frames.start).unwrap_or(usize::MAX).div_ceil(LOOKED_AT).max(1);
    for number in frames.step_by(stride) {
        if recording.people(number)?.iter().any(|view| view.len() > 1) {
            return Ok(true);
        }
    }
    Ok(false)
}
