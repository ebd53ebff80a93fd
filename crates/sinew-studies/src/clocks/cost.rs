//! What an unknown lag costs: errors and coverage of limb joints.

use super::recorded::{Clocks, Walk};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::with_error;
use crate::support::table::{header, row};
use crate::trackers::worth;
use std::ops::Range;
use std::path::Path;

/// Frames a second, seconds, and frames that one camera is late.
const FPS: f64 = 30.0;
const SECONDS: f64 = 4.0;
const LAGS: [f64; 5] = [0.0, 0.3, 0.5, 1.5, 7.5];

/// How the recording is read: flags of `sinew track`.
const READINGS: [(&str, &str); 3] = [("as it is", ""), ("`--lag`, the true one", "--lag"), ("`--sync`", "--sync")];

fn tracked(program: &Program, folder: &Path, more: &[String]) -> Outcome<worth::Worth> {
    let (calibration, keypoints, out) = (folder.join("Calib.toml"), folder.join("pose"), folder.join("out"));
    let fps = FPS.to_string();
    let flags = ["--calibration", &shown(&calibration), "--keypoints", &shown(&keypoints), "--fps", &fps];
    let rest = ["--force", "--no-progress", "--threads", "1"];
    let flags = flags.into_iter().chain(rest).map(str::to_owned).chain(more.iter().cloned());
    program.track(&flags.collect::<Vec<_>>(), &out)?;
    worth::of(&out, &folder.join("truth.trc"))
}

/// The table.
pub(super) fn table(program: &Program, seeds: Range<u64>) -> Outcome<String> {
    let mut text = header("| one camera late by | read | error, mm | inside 90 % intervals, % |");
    let folder = program.folder.join("walk");
    for lag in LAGS {
        for (words, flag) in READINGS {
            if lag == 0.0 && flag == "--lag" {
                continue;
            }
            let (mut errors, mut covered) = (vec![], vec![]);
            for seed in seeds.clone() {
                let clocks = if lag == 0.0 { Clocks::IN_STEP } else { Clocks::one_late(seed, lag) };
                let late = clocks.lags.iter().position(|lag| *lag != 0.0).unwrap_or(0);
                Walk { seed, fps: FPS, seconds: SECONDS, treadmill: false, clocks }.write(&folder)?;
                let more = match flag {
                    "" => vec![],
                    "--lag" => vec!["--lag".into(), format!("C{}={lag}", late + 1)],
                    other => vec![other.to_owned()],
                };
                let found = tracked(program, &folder, &more)?;
                errors.push(found.error_mm);
                covered.push(100.0 * found.covered);
            }
            row!(text, "{lag} | {words} | {} | {}", with_error(&errors, 3), with_error(&covered, 3));
        }
    }
    Ok(text)
}
