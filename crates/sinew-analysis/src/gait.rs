//! Gait of a person who walks, from a result folder: events, parameters of strides, angles over the cycle.
//!
//! 1. Pelvis and feet are read with their draws (`walk`); the pelvis says where the person walks (`progression`).
//! 2. Heel strikes and toe offs are where heels and toes are farthest ahead and behind (`events`).
//! 3. Strides between them have lengths, times and shares of the cycle (`strides`), and these a mean and a spread (`summary`).
//! 4. Angles, the pelvis against the direction of walking (`pelvis`), are cut at the heel strikes and laid over each other (`cycles`).
//!
//! Intervals are of 90 %, from the draws of the run; what they hold is measured in docs/evidence/gait.md. Draws of a run with `--smooth` are whole paths. Of a run without it they share, from frame to frame, only what lasts over the run.

mod analysis;
mod cycles;
pub(crate) mod error;
mod events;
mod local_polynomial;
mod pelvis;
mod picture;
mod progression;
mod strides;
mod summary;
mod tables;
mod varied;
mod walk;

pub use analysis::GaitAnalysis;
pub use cycles::{AngleCycle, PLACES};
pub use error::GaitError;
pub use events::{GaitEvent, GaitEventKind};
pub use picture::gait_picture;
pub use strides::{PARAMETERS, Stride};
pub use summary::{ParameterSummary, summary};
pub use varied::Varied;

use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew::setup::Setup;
use sinew_formats::json_text;
use sinew_formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES};
use sinew_input::flag::flag;
use sinew_results::people::refuse_several;
use sinew_results::{GAIT_NAMES, without_summary};
use std::path::Path;
use walk::Walk;

/// What is said of results that are not smoothed; shares as measured in docs/evidence/gait.md at 60 frames a second.
const FILTERED: &str = "of filtered results 79 to 86 % of the events lie inside their 90 % \
     intervals where errors of keypoints persist, as they do in recordings, of smoothed ones 91 to 95 %";

/// The gait in a result folder.
///
/// # Errors
/// A folder without results or files of it, tables that do not belong together, numbers that are none, and a person who does not walk.
pub fn gait(folder: &Path) -> Result<GaitAnalysis, Error> {
    refuse_several(folder).map_err(sinew::Error::from)?;
    let path = folder.join("summary.json");
    if !path.exists() {
        return Err(without_summary(folder).into());
    }
    let run: Value = json_text::parse(&path.display().to_string(), &read_text(&path, MAX_TEXT_BYTES)?)?;
    let apart_s = if run["kind"].as_str() == Some("smoothed") { apart_s(folder)? } else { f64::INFINITY };
    let walk = Walk::read(folder, apart_s)?;
    let events = events::events(&walk);
    if !events.iter().any(|event| event.kind == GaitEventKind::HeelStrike) {
        return Err(GaitError::NoSteps { folder: folder.to_owned(), far_m: way_m(&walk) }.into());
    }
    let strides = strides::strides(&walk, &events);
    let event_frames = events.iter().map(|event| walk.frame_at(event.time_s)).collect();
    let series = cycles::series(folder, walk.times_s.len())?;
    let (series, about_pelvis) = pelvis::heading_free(folder, &run, &walk, series)?;
    let cycles = cycles::cycles(&series, &walk.times_s, &strides);
    let mut warnings = warnings(&run, &walk, &strides);
    warnings.extend(about_pelvis);
    Ok(GaitAnalysis { event_frames, cycles, warnings, events, strides })
}

/// Time after which errors of the detectors are independent: twice their time constant, the integral of an exponential correlation over both directions of time.
///
/// Draws hold how large such errors are, frame by frame, not how long they last.
fn apart_s(folder: &Path) -> Result<f64, Error> {
    let path = folder.join("setup.toml");
    if !path.exists() {
        return Ok(0.0);
    }
    let setup = Setup::from_toml(&path.display().to_string(), &read_text(&path, MAX_CONFIG_BYTES)?)?;
    Ok(setup.lasting.map_or(0.0, |known| 2.0 * known.persistence_s))
}

/// How far the pelvis gets from where it began, on the ground.
fn way_m(walk: &Walk) -> f64 {
    let mean = &walk.pelvis.mean;
    mean.iter().map(|p| (p[0] - mean[0][0]).hypot(p[1] - mean[0][1])).fold(0.0, f64::max)
}

fn warnings(run: &Value, walk: &Walk, strides: &[Stride]) -> Vec<String> {
    let mut found = vec![];
    if walk.draws() > 0 && run["kind"].as_str() != Some("smoothed") {
        found.push(format!("track with {}: {FILTERED}", flag("smooth")));
    }
    if strides.is_empty() {
        found.push(
            "no foot strikes twice in a row: there are events, but no stride to measure and no cycle of angles".into(),
        );
    }
    if walk.ankles_only {
        found.push(
            "the keypoints have no heels and toes: events and places are of the ankles, which strike and leave at \
             other times"
                .into(),
        );
    }
    if walk.draws() == 0 {
        found.push("the folder has no draws, or more than can be read: there are no intervals".into());
    }
    found
}

/// Names and texts of the files; the picture has a title.
///
/// # Errors
/// None but of memory.
pub fn gait_files(gait: &GaitAnalysis, title: &str) -> Result<[(&'static str, String); 4], Error> {
    let texts = [tables::events(gait)?, tables::parameters(gait)?, tables::cycles(gait)?, gait_picture(title, gait)];
    let mut texts = texts.into_iter();
    Ok(GAIT_NAMES.map(|name| (name, texts.next().unwrap_or_default())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::setup::lasting_errors::{DrawnNumber, MeasuredErrors, VERSION};
    use sinew::setup::{SetupRequest, unmeasured};

    /// The correlation exp(−|t|/τ) has the integral 2 τ.
    #[test]
    fn errors_are_independent_after_the_integral_of_their_correlation() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(apart_s(folder.path()).unwrap(), 0.0);
        let layout = sinew::formats::layout::find("body-25b").unwrap();
        let mut setup = unmeasured(&layout, &SetupRequest::default(), vec![]);
        setup.start_pose = vec![0.0; setup.tree().dof()];
        let zero = || DrawnNumber { name: "0".into(), value: 0.0, prior_mean: 0.0, prior_sd: 1.0, draws: vec![0.0] };
        for (lasting, expected) in [(None, 0.0), (Some(0.35), 0.7)] {
            setup.lasting = lasting.map(|persistence_s| MeasuredErrors {
                version: VERSION,
                persistence_s,
                number: std::iter::repeat_with(zero).take(9).collect(),
                ..MeasuredErrors::default()
            });
            std::fs::write(folder.path().join("setup.toml"), setup.to_toml().unwrap()).unwrap();
            assert_eq!(apart_s(folder.path()).unwrap(), expected);
        }
    }
}
