//! `--static`: somebody whose feet and head rest otherwise than the body's zero pose has them.
//!
//! The soles of a simulated walker, in the frames of the feet, rise towards the toes by [`SOLE_DEG`], and the face looks down by [`FACE_DEG`]: as in shoes with heels and by the habit of a neck. Keypoints show the soles and the face, and a tracker takes soles for
//! level and faces for upright at zero. The walker stands for the first second, then walks:
//!
//! 1. the whole recording is tracked, as a user would begin;
//! 2. the standing second again, smoothed, with that set-up: the standing trial;
//! 3. the rest with that set-up and `--static`.
//!
//! The truth of 3 is the walker's true angles less their mean over the standing second; the truth of 1 is the true angles.

use super::angles::{Angles, shares, tallied, true_angles, written};
use super::protocol::{FIRST_ANGLES, LAYOUT};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown, write_recording};
use crate::support::store::Store;
use crate::support::table::header;
use serde_json::{Value, json};
use sinew::body::Proportions;
use sinew::core::random::Stage;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::fmt::Write as _;
use std::fs;
use std::ops::Range;
use std::path::Path;

const SOLE_DEG: f64 = 8.0;
const FACE_DEG: f64 = 12.0;

/// Frames of standing.
const STANDING: usize = 30;

/// A place turned about the right axis.
fn pitched([x, y, z]: [f64; 3], degrees: f64) -> [f64; 3] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [x, cos * y - sin * z, sin * y + cos * z]
}

/// Somebody of these sizes whose feet and head rest otherwise.
fn resting_otherwise(sizes: Proportions) -> Proportions {
    let Proportions { heel, big_toe, small_toe, nose, eye, ear, head_top, .. } = sizes;
    let [heel, big_toe, small_toe] = [heel, big_toe, small_toe].map(|at| pitched(at, SOLE_DEG));
    let [nose, eye, ear, head_top] = [nose, eye, ear, head_top].map(|at| pitched(at, -FACE_DEG));
    Proportions { heel, big_toe, small_toe, nose, eye, ear, head_top, ..sizes }
}

/// True angles less their mean over the standing second, but OpenSim's of the pelvis, which depend on the heading.
fn zeroed(truth: &[Angles]) -> Vec<Angles> {
    let zero = |name: &str| {
        let of =
            |part: fn(f64) -> f64| truth[..STANDING].iter().map(|angles| part(angles[name].to_radians())).sum::<f64>();
        if name.starts_with("pelvis_") { 0.0 } else { of(f64::sin).atan2(of(f64::cos)).to_degrees() }
    };
    let zeros: Angles = truth[0].keys().map(|name| (name.clone(), zero(name))).collect();
    truth
        .iter()
        .map(|angles| angles.iter().map(|(name, angle)| (name.clone(), angle - zeros[name])).collect())
        .collect()
}

/// The walker of a seed, with and without a standing trial.
pub(super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    let noise = DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE };
    let proportions = resting_otherwise(adult::drawn(&Stage::new(seed, "walker")));
    let script = Script { calibration: CalibrationError::USUAL, noise, proportions, ..Script::default() };
    let recording = SyntheticRecording::new(&script, seed)?;
    let truth: Vec<Angles> =
        recording.states.iter().map(|state| true_angles(&recording.body, state)).collect::<Outcome<_>>()?;
    let folder = program.folder.join(format!("standing-{seed}"));
    write_recording(&folder, &recording.calibration_toml(), "keypoints", recording.keypoint_files())?;
    let [calibration, keypoints] = ["Calib.toml", "keypoints"].map(|name| shown(&folder.join(name)));
    let (rate, seed) = (script.rate_hz.to_string(), seed.to_string());
    let files = ["--calibration", &calibration, "--keypoints", &keypoints, "--layout", LAYOUT, "--fps", &rate];
    let rest = ["--seed", &seed, "--threads", "1", "--force", "--no-progress"];
    let [first, trial, walk] = ["first", "trial", "walk"].map(|name| folder.join(name));
    let setup = shown(&first.join("setup.toml"));
    let run = |more: &[&str], out: &Path| {
        let flags: Vec<String> = files.iter().chain(&rest).chain(more).map(|flag| (*flag).to_owned()).collect();
        program.track(&flags, out)
    };
    let [standing, walking] = [format!("0..{STANDING}"), format!("{STANDING}..{}", truth.len())];
    run(&[], &first)?;
    run(&["--setup", &setup, "--frames", &standing, "--smooth"], &trial)?;
    run(&["--setup", &setup, "--frames", &walking, "--static", &shown(&trial)], &walk)?;
    let found = json!({
        "as it is": tallied(&first, &truth, script.rate_hz, [2, 0])?,
        "zeroed": tallied(&walk, &zeroed(&truth), script.rate_hz, [2, 0])?,
    });
    fs::remove_dir_all(&folder)?;
    Ok(found)
}

/// What the names of cells begin with.
pub(super) const CELLS: &str = "standing";

/// Angles with and without a standing trial.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<&Value> = store.for_seeds(CELLS, seeds);
    let mut text = format!(
        "{} walkers, seeds from {FIRST_ANGLES}, whose soles rest {SOLE_DEG}° and whose faces rest {FACE_DEG}° from the body's zero:\n\n",
        cells.len()
    );
    let head = "inside 90 % intervals, % | mean error, ° | half-width, ° ";
    text += &header(&format!("| angles that are seen | without `--static`: {head}| with it: {head}|"));
    for (what, wanted) in [
        ("`ankle_angle`", Some("ankle_angle")),
        ("`foot_ry`", Some("foot_ry")),
        ("`head_rx`", Some("head_rx")),
        ("`knee_angle`", Some("knee_angle")),
        ("`hip_flexion`", Some("hip_flexion")),
        ("all", None),
    ] {
        let of = |kind: &str| written(&shares(&cells, kind, 0, wanted)).1;
        let _ = writeln!(text, "| {what} {}{}|", of("as it is"), of("zeroed"));
    }
    text
}
