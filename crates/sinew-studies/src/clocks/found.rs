//! What `sinew sync` finds in a recording, against its clocks.

use super::recorded::{CAMERAS, Clocks, Walk};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use serde_json::Value;
use std::path::Path;

/// The answer of `sinew sync --json` for keypoints of a folder.
pub(super) fn answer(program: &Program, calibration: &Path, keypoints: &Path, fps: f64) -> Outcome<Value> {
    let (calibration, keypoints, fps) = (shown(calibration), shown(keypoints), fps.to_string());
    let flags = ["sync", "--json", "--calibration", &calibration, "--keypoints", &keypoints, "--fps", &fps];
    Ok(serde_json::from_str(&program.run(&flags.map(str::to_owned), &[0, 4])?)?)
}

/// The same for a walk.
pub(super) fn clocks(program: &Program, walk: &Walk) -> Outcome<Value> {
    let folder = program.folder.join("walk");
    walk.write(&folder)?;
    answer(program, &folder.join("Calib.toml"), &folder.join("pose"), walk.fps)
}

/// Lag and its standard deviation of every camera; 0 and infinity where it was not found.
pub(super) fn lags(found: &Value) -> Vec<[f64; 2]> {
    let cameras = found["cameras"].as_array().map(Vec::as_slice).unwrap_or_default();
    let number = |camera: &Value, name: &str, or: f64| camera[name].as_f64().unwrap_or(or);
    cameras.iter().map(|c| [number(c, "lag_frames", 0.0), number(c, "lag_sd_frames", f64::INFINITY)]).collect()
}

/// Errors of lags and their standard deviations: of the late camera where one is, else of all, about their mean.
pub(super) fn errors(found: &Value, clocks: &Clocks) -> Vec<[f64; 2]> {
    let lags = lags(found);
    let late: Vec<usize> = (0..CAMERAS).filter(|&c| clocks.lags[c] != 0.0).collect();
    let error = |c: usize| lags[c][0] - clocks.lags[c];
    // Against the cameras that are in step, or against all.
    let others: Vec<usize> = match late[..] {
        [one] => (0..CAMERAS).filter(|&c| c != one).collect(),
        _ => (0..CAMERAS).collect(),
    };
    let mean = others.iter().map(|&c| error(c)).sum::<f64>() / others.len() as f64;
    late.into_iter().map(|c| [error(c) - mean, lags[c][1]]).collect()
}

fn drifting(clocks: &Clocks) -> usize {
    (0..CAMERAS).find(|&c| clocks.ppm[c] != 0.0).unwrap_or(0)
}

/// Drift of the camera that drifts, against the others, and its standard deviation.
pub(super) fn drift(found: &Value, clocks: &Clocks) -> Option<[f64; 2]> {
    let own = drifting(clocks);
    let drift = |c: usize| found["cameras"][c]["drift_ppm"].as_f64();
    let others = (0..CAMERAS).filter(|&c| c != own).filter_map(drift).sum::<f64>() / (CAMERAS - 1) as f64;
    Some([drift(own)? - others, found["cameras"][own]["drift_sd_ppm"].as_f64()?])
}

/// Errors, frames, of the drifting camera's lag as the setting has it, in the first frame and in the last.
pub(super) fn end_errors(found: &Value, clocks: &Clocks, frames: f64) -> [f64; 2] {
    let own = drifting(clocks);
    let declared = |c: usize| -> [f64; 2] {
        let text = found["cameras"][c]["lag"].as_str().unwrap_or("0");
        let lag: sinew::input::lag::ClockLag = text.parse().unwrap_or_default();
        [lag.frames, lag.ppm]
    };
    let at = |c: usize, frame: f64| declared(c)[0] + 1e-6 * declared(c)[1] * frame;
    [0.0, frames].map(|frame| {
        let others = (0..CAMERAS).filter(|&c| c != own).map(|c| at(c, frame)).sum::<f64>() / (CAMERAS - 1) as f64;
        at(own, frame) - others - clocks.lags[own] - 1e-6 * clocks.ppm[own] * frame
    })
}
