//! Do intervals of joint angles, meant over trials, hold the truth?
//!
//! With one set-up for all trials, and with set-ups of their own. A simulated walker a subject, of another size, before cameras that differ from their calibration as real ones do, cut into four trials of two seconds. `groups.csv` has the mean over the trials of each angle's mean over time; the truth is that of the true angles. Counted
//! are angles that keypoints show in every frame.

use super::keypoint_tables::write_keypoints;
use crate::intervals::true_angles;
use crate::outcome::Outcome;
use crate::program::{Program, shown};
use serde_json::Value;
use sinew::core::random::Stage;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::Path;

/// Trials of a subject, and frames of a trial; before them the walker stands.
const TRIALS: usize = 4;
const FRAMES: usize = 60;
const STANDING: usize = 30;
/// Seeds of the subjects begin here.
const FIRST: u64 = 3001;

/// Inside, error and half-width, means over the angles of a subject.
type Held = [f64; 3];

/// The table.
pub(super) fn table(program: &Program, folder: &Path, subjects: usize) -> Outcome<String> {
    let mut rows: BTreeMap<&str, Vec<Held>> = BTreeMap::new();
    for seed in (FIRST..).take(subjects) {
        let script = script(seed);
        let walk = SyntheticRecording::new(&script, seed)?;
        for (name, settings) in [("one set-up", "subject = \"S\"\n"), ("set-ups of their own", "people = \"1\"\n")] {
            let at = folder.join("groups");
            if at.exists() {
                fs::remove_dir_all(&at)?;
            }
            write_trials(&walk, &at.join("trials/S"), settings)?;
            rows.entry(name).or_default().push(held(program, &walk, &at)?);
        }
    }
    let mut text =
        "| set-up of the four trials | inside 90 % intervals, % | mean error, ° | half-width, ° |\n|---|---|---|---|\n"
            .to_owned();
    for (name, subjects) in &rows {
        let column = |place: usize, factor: f64| {
            let values: Vec<f64> = subjects.iter().map(|held| factor * held[place]).collect();
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let square: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            format!("{mean:.2} ± {:.2}", (square / (count - 1.0) / count).sqrt())
        };
        text += &format!("| {name} | {} | {} | {} |\n", column(0, 100.0), column(1, 1.0), column(2, 1.0));
    }
    Ok(text)
}

fn script(seed: u64) -> Script {
    let frames = STANDING + TRIALS * FRAMES;
    let base = Script::default();
    Script {
        duration_s: (frames + 1) as f64 / base.rate_hz,
        proportions: adult::drawn(&Stage::new(seed, "walker")),
        calibration: CalibrationError::USUAL,
        ..base
    }
}

/// Frames of a trial in the walk.
fn frames(trial: usize) -> Range<usize> {
    let first = STANDING + trial * FRAMES;
    first..first + FRAMES
}

fn write_trials(walk: &SyntheticRecording, folder: &Path, settings: &str) -> Outcome<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("Calib.toml"), walk.calibration_toml())?;
    let rate = walk.rate_hz;
    fs::write(
        folder.join("sinew.toml"),
        format!("root = true\ncalibration = \"Calib.toml\"\nfps = {rate}\nlayout = \"BODY_25B\"\n{settings}"),
    )?;
    for trial in 0..TRIALS {
        let own = folder.join(format!("T{trial}"));
        for (camera, keypoints) in walk.cameras.iter().zip(&walk.keypoints) {
            write_keypoints(walk, camera, &keypoints[frames(trial)], &own)?;
        }
    }
    Ok(())
}

/// A subject's study against the truth.
fn held(program: &Program, walk: &SyntheticRecording, at: &Path) -> Outcome<Held> {
    let (trials, study) = (shown(&at.join("trials")), shown(&at.join("study")));
    let run = |arguments: &[&str]| program.run(&arguments.iter().map(|a| (*a).to_owned()).collect::<Vec<_>>(), &[0, 4]);
    run(&["batch", "plan", &trials, "-o", &study])?;
    run(&["batch", "run", &study, "-qq"])?;
    run(&["batch", "gather", &study])?;
    let mut unseen = BTreeSet::new();
    for trial in 0..TRIALS {
        let path = at.join(format!("study/results/S/T{trial}/summary.json"));
        let summary: Value = serde_json::from_str(&fs::read_to_string(path)?)?;
        unseen.extend(summary["angles"]["unseen"].as_object().into_iter().flat_map(|all| all.keys().cloned()));
    }
    let mut truth: BTreeMap<String, f64> = BTreeMap::new();
    for state in (0..TRIALS).flat_map(frames).map(|frame| &walk.states[frame]) {
        for (name, angle) in true_angles(&walk.body, state)? {
            *truth.entry(name).or_default() += angle / (TRIALS * FRAMES) as f64;
        }
    }
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for line in fs::read_to_string(at.join("study/groups.csv"))?.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let [_, angle, _, _, mean, low, high, _] = cells[..] else { return Err(format!("a row `{line}`").into()) };
        if unseen.contains(angle) {
            continue;
        }
        let known = truth.get(angle).ok_or(format!("no truth of {angle}"))?;
        let (mean, low, high): (f64, f64, f64) = (mean.parse()?, low.parse()?, high.parse()?);
        sum[0] += f64::from(u8::from((low..=high).contains(known)));
        sum[1] += (mean - known).abs();
        sum[2] += 0.5 * (high - low);
        count += 1.0;
    }
    Ok(sum.map(|sum| sum / count))
}
