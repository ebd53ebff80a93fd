//! Recorded walks of a person before simulated cameras: people do not repeat themselves as the generator does.
//!
//! Nine walks of subject 07 of the CMU motion capture database, at 120 frames a second. Its skeletons have no heels: no heel is ever detected, and the tracker has them from the rest of the foot. Truth are extrema of ankles and big toes in the recorded motion itself.

use super::truth::recorded;
use super::walkers::{Due, Table, judged_events, tracked};
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use serde_json::{Value, json};
use sinew::body::Proportions;
use sinew::body::standard::h32;
use sinew_motion::convert::recorded_joints;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::path::Path;

/// The walks, by the ends of their names.
pub(super) const WALKS: [&str; 9] = ["01", "02", "04", "05", "06", "07", "08", "09", "10"];
/// Time at both ends of a recording in which events need not be found, seconds.
const ENDS_S: f64 = 0.5;
const RECORDED_HZ: f64 = 120.0;

/// A walk, tracked and read.
pub(super) fn cell(program: &Program, data: &Path, walk: &str, rate_hz: f64) -> Outcome<Value> {
    let (motion, skeleton) = (data.join(format!("cmu_amc/07_{walk}.amc")), data.join("cmu_amc/07.asf"));
    let at = |rate_hz: f64| recorded_joints(&motion, Some(&skeleton), None, |_| rate_hz);
    let noise = DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script { rate_hz, calibration: CalibrationError::USUAL, noise, ..Script::default() };
    let body = h32(&Proportions::default());
    let seed = walk.parse()?;
    let recording = SyntheticRecording::from_motion(body, vec![], at(rate_hz)?.motion, &script, seed)?;
    let folder = program.folder.join(format!("recorded-{walk}-{rate_hz}"));
    let out = tracked(program, &recording, &folder, (seed, true))?;
    let motion = at(RECORDED_HZ)?.motion;
    let truth = recorded(&motion, RECORDED_HZ)?;
    let end_s = motion.frames.len() as f64 / RECORDED_HZ;
    let due = Due { events: &truth, from_s: ENDS_S, to_s: end_s - ENDS_S };
    let events = judged_events(&Table::read(&out, "gait_events.csv")?, &due)?;
    std::fs::remove_dir_all(&folder)?;
    Ok(json!({ "events": events }))
}
