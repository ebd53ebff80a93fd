//! Simulated walkers, tracked and read by the program, against their truth.

use super::truth::{TrueEvent, events, stride};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown, write_recording};
use serde_json::{Map, Value, json};
use sinew::core::random::Stage;
use sinew::formats::tidy_csv::{Cells, read_cells};
use sinew_analysis::gait::PARAMETERS;
use sinew_body::points::points_of_states;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::path::{Path, PathBuf};

/// Seconds of a recording.
const DURATION_S: f64 = 8.0;
/// An event within this time of a true one is that one, seconds.
const NEAR_S: f64 = 0.15;
/// Time at the end of a recording in which events need not be found, seconds: a stride's half has to follow.
const END_S: f64 = 0.5;

/// Walkers differ in size and in cadence: strides of 0.95 to 1.25 s.
fn walker(seed: u64) -> Walker {
    let stride_s = 0.95 + 0.03 * (seed % 11) as f64;
    let proportions = adult::drawn(&Stage::new(seed, "walker"));
    Walker::new(Gait { stride_s, duration_s: DURATION_S, proportions, ..Gait::default() })
}

/// The walker before four cameras that err as in demos, with a detector whose errors persist from frame to frame by a factor.
fn recording(walker: &Walker, rate_hz: f64, persistence: f64, seed: u64) -> Outcome<SyntheticRecording> {
    let noise = DetectorNoise { offset_px: 0.0, persistence, ..DetectorNoise::DETECTOR_LIKE };
    let script = Script { rate_hz, calibration: CalibrationError::USUAL, noise, ..Script::default() };
    let states = walker_states(walker, rate_hz);
    let truth = points_of_states(&walker.body, &states);
    Ok(SyntheticRecording::from_motion(walker.body.clone(), states, truth, &script, seed)?)
}

/// A table of the program.
pub(super) struct Table(Cells);

impl Table {
    pub(super) fn read(folder: &Path, name: &str) -> Outcome<Self> {
        Ok(Self(read_cells(name, &std::fs::read_to_string(folder.join(name))?)?))
    }

    fn cell(&self, row: usize, column: &str) -> Outcome<&str> {
        let place = self.0.columns.iter().position(|own| own == column).ok_or(format!("no column {column}"))?;
        Ok(&self.0.rows[row].1[place])
    }

    fn number(&self, row: usize, column: &str) -> Outcome<f64> {
        let cell = self.cell(row, column)?;
        if cell.is_empty() { Ok(f64::NAN) } else { Ok(cell.parse()?) }
    }

    fn rows(&self) -> usize {
        self.0.rows.len()
    }
}

/// Column of an end of the interval of a parameter.
fn end_column(parameter: &str, end: &str) -> String {
    let units = ["_m_per_s", "_per_min", "_m", "_s", "_share"];
    let unit = units.into_iter().find(|unit| parameter.ends_with(unit)).unwrap_or_default();
    format!("{}_{end}{unit}", &parameter[..parameter.len() - unit.len()])
}

/// True events of a recording, and the times between which they have to be found.
pub(super) struct Due<'a> {
    pub(super) events: &'a [TrueEvent],
    pub(super) from_s: f64,
    pub(super) to_s: f64,
}

/// Error, ends of the interval less the truth, and time of the contact less that of the extremum, of each event found; and how many were missed or do not exist.
pub(super) fn judged_events(table: &Table, Due { events: truth, from_s, to_s }: &Due<'_>) -> Outcome<Value> {
    let mut found = [vec![], vec![]];
    let mut extra = 0;
    let mut seen = vec![false; truth.len()];
    for row in 0..table.rows() {
        let (side, is_strike) = (table.cell(row, "side")?, table.cell(row, "event")? == "heel_strike");
        let time = table.number(row, "time_s")?;
        let is_it = |event: &&TrueEvent| (["left", "right"][event.side], event.is_strike) == (side, is_strike);
        let own = truth.iter().enumerate().filter(|(_, event)| is_it(event));
        let nearest = own.min_by(|a, b| {
            let away = |event: &TrueEvent| (event.extremum_s - time).abs();
            away(a.1).total_cmp(&away(b.1))
        });
        match nearest.filter(|(place, event)| (event.extremum_s - time).abs() < NEAR_S && !seen[*place]) {
            Some((place, event)) => {
                seen[place] = true;
                let ends = [table.number(row, "time_q05_s")?, table.number(row, "time_q95_s")?];
                let [low, high] = ends.map(|end| end - event.extremum_s);
                let error = time - event.extremum_s;
                found[usize::from(is_strike)].push(json!([error, low, high, event.contact_s - event.extremum_s]));
            }
            None => extra += 1,
        }
    }
    let is_due = |event: &TrueEvent| event.contact_s > *from_s && event.contact_s < *to_s;
    let missed = truth.iter().zip(&seen).filter(|(event, seen)| is_due(event) && !**seen).count();
    let due = truth.iter().filter(|event| is_due(event)).count();
    Ok(json!({ "toe_off": found[0], "heel_strike": found[1], "extra": extra, "missed": missed, "due": due }))
}

/// Error and ends of the interval less the truth of every parameter: of each stride, and of the means of all.
fn judged_parameters(table: &Table, truth: &[TrueEvent]) -> Outcome<Value> {
    let mut strides: Vec<Vec<Value>> = vec![vec![]; PARAMETERS.len()];
    let mut means: Vec<(f64, f64)> = vec![(0.0, 0.0); PARAMETERS.len()];
    let mut walk_means = Map::new();
    for row in 0..table.rows() {
        let side = table.cell(row, "side")?;
        let (kind, start) = (table.cell(row, "row")?, table.number(row, "start_s")?);
        let is_it = |event: &TrueEvent| {
            event.is_strike && ["left", "right"][event.side] == side && (event.extremum_s - start).abs() < NEAR_S
        };
        let expected = truth.iter().position(is_it).and_then(|start| stride(truth, start));
        for (k, name) in PARAMETERS.iter().enumerate() {
            let value = table.number(row, name)?;
            let ends = [table.number(row, &end_column(name, "q05"))?, table.number(row, &end_column(name, "q95"))?];
            if let ("stride", Some(expected)) = (kind, expected.map(|all| all[k]))
                && value.is_finite()
            {
                strides[k].push(json!([value - expected, ends[0] - expected, ends[1] - expected]));
                means[k] = (means[k].0 + expected, means[k].1 + 1.0);
            } else if (kind, side) == ("mean", "both") && value.is_finite() {
                let expected = means[k].0 / means[k].1;
                walk_means.insert((*name).into(), json!([value - expected, ends[0] - expected, ends[1] - expected]));
            }
        }
    }
    let strides: Map<String, Value> =
        PARAMETERS.iter().map(|name| (*name).to_owned()).zip(strides.into_iter().map(Value::from)).collect();
    Ok(json!({ "strides": strides, "means": walk_means }))
}

/// Writes a recording, tracks it with a seed and reads its gait, all in a folder; gives that of the results.
pub(super) fn tracked(
    program: &Program,
    recording: &SyntheticRecording,
    folder: &Path,
    (seed, smooth): (u64, bool),
) -> Outcome<PathBuf> {
    std::fs::create_dir_all(folder)?;
    write_recording(folder, &recording.calibration_toml(), "keypoints", recording.keypoint_files())?;
    let [calibration, keypoints] = ["Calib.toml", "keypoints"].map(|name| shown(&folder.join(name)));
    let [fps, seed] = [recording.rate_hz.to_string(), seed.to_string()];
    let files = ["--calibration", &calibration, "--keypoints", &keypoints, "--layout", "BODY_25B", "--fps", &fps];
    let rest = ["--threads", "1", "--no-progress", "--force", "--seed", &seed];
    let smoothed: &[&str] = if smooth { &["--smooth"] } else { &[] };
    let flags: Vec<String> = files.iter().chain(&rest).chain(smoothed).map(|flag| (*flag).to_owned()).collect();
    let out = folder.join("out");
    program.track(&flags, &out)?;
    program.run(&["gait".to_owned(), shown(&out), "--force".to_owned(), "-q".to_owned()], &[0])?;
    Ok(out)
}

/// A walker, tracked and read.
pub(super) fn cell(program: &Program, seed: u64, rate_hz: f64, persistence: f64, smooth: bool) -> Outcome<Value> {
    let walker = walker(seed);
    let folder = program.folder.join(format!("walker-{seed}-{rate_hz}-{persistence}-{smooth}"));
    let out = tracked(program, &recording(&walker, rate_hz, persistence, seed)?, &folder, (seed, smooth))?;
    let truth = events(&walker)?;
    let from_s = walker.gait.still_s + walker.gait.start_s;
    let due = Due { events: &truth, from_s, to_s: DURATION_S - END_S };
    let events = judged_events(&Table::read(&out, "gait_events.csv")?, &due)?;
    let parameters = judged_parameters(&Table::read(&out, "gait_parameters.csv")?, &truth)?;
    std::fs::remove_dir_all(&folder)?;
    Ok(json!({ "events": events, "parameters": parameters }))
}
