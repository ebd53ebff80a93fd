//! Real recordings of which one camera is shifted: by whole frames, and by half frames at half the rate.
//!
//! At half the rate, all cameras keep their even frames and the shifted one takes odd ones. What is judged is the lag against that of the same recording, at the same rate, as it is.

use super::found::{answer, lags};
use super::measures::inside;
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::rms;
use crate::support::table::{header, row};
use std::path::{Path, PathBuf};

/// Every how many frames are kept, and frames of the whole recording that the camera is late.
const SHIFTS: [(u64, u64); 5] = [(1, 3), (1, 7), (2, 1), (2, 3), (2, 15)];

/// Frames a second of the recordings.
const FPS: f64 = 60.0;

/// Recordings: folder of the data, calibration, keypoints.
const RECORDINGS: [[&str; 3]; 2] =
    [["pose2sim_single", "Calib.toml", "T01_BalancingTrial/pose"], ["pose2sim_two_people", "Calib.toml", "pose"]];

/// Writes a recording of which every `step`-th frame is kept, and one camera is late.
fn write(from: &Path, to: &Path, late: Option<usize>, step: u64, lag: u64) -> Outcome<()> {
    if to.exists() {
        std::fs::remove_dir_all(to)?;
    }
    let mut folders: Vec<PathBuf> =
        std::fs::read_dir(from)?.map(|entry| entry.map(|e| e.path())).collect::<Result<_, _>>()?;
    folders.retain(|folder| folder.is_dir());
    folders.sort();
    for (index, folder) in folders.iter().enumerate() {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let out = to.join(&name);
        std::fs::create_dir_all(&out)?;
        for entry in std::fs::read_dir(folder)? {
            let path = entry?.path();
            let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let Some(number) = sinew::formats::frame_number::parse(&file) else { continue };
            let shown = number + if late == Some(index) { lag } else { 0 };
            if shown % step == 0 {
                std::fs::write(out.join(format!("{name}.{:06}.json", shown / step)), std::fs::read(&path)?)?;
            }
        }
    }
    Ok(())
}

/// The table.
pub(super) fn table(program: &Program) -> Outcome<String> {
    let mut text = header(
        "| recording | shifted by, frames | error, root mean square, frames | largest | inside 90 % intervals, % |",
    );
    for [name, calibration, keypoints] in RECORDINGS {
        let Some(data) = sinew_tests::data::shared(name) else { continue };
        let (calibration, folder) = (data.join(calibration), program.folder.join("shifted"));
        let found = |late: Option<usize>, step: u64, lag: u64| -> Outcome<Vec<[f64; 2]>> {
            write(&data.join(keypoints), &folder, late, step, lag)?;
            Ok(lags(&answer(program, &calibration, &folder, FPS / step as f64)?))
        };
        for (step, lag) in SHIFTS {
            let as_it_is = found(None, step, 0)?;
            let truth = lag as f64 / step as f64;
            let (mut errors, mut standardised) = (vec![], vec![]);
            for camera in 0..as_it_is.len() {
                let shifted = found(Some(camera), step, lag)?;
                let others = || (0..as_it_is.len()).filter(|c| *c != camera);
                let against = |lags: &[[f64; 2]]| {
                    lags[camera][0] - others().map(|c| lags[c][0]).sum::<f64>() / others().count() as f64
                };
                let error = against(&shifted) - against(&as_it_is) - truth;
                errors.push(error);
                standardised.push(error / shifted[camera][1]);
            }
            let largest = errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()));
            row!(text, "`{name}` | {truth} | {:.3} | {largest:.2} | {:.0}", rms(&errors), inside(&standardised));
        }
    }
    Ok(text)
}
