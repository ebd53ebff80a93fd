//! `sinew sync`: how late cameras are against each other; and `sinew track --sync`, which reads the recording with that.

use super::args::{General, MOST_APART, SyncArgs};
use super::ended::Ended;
use super::error::Error;
use super::interrupt;
use super::report::{self, Report};
use super::table::aligned;
use super::terminal::Terminal;
use serde_json::json;
use sinew::config::common::{LAG, TRIM};
use sinew::config::{Resolved, TrackConfig};
use sinew::run::settings::{settings, with_stated_rate};
use sinew_analysis::sync::{FoundClock, FoundClocks, SyncRequest, synchronise};
use std::ops::Range;
use std::sync::atomic::Ordering;

/// Runs the command.
pub(crate) fn run(args: &SyncArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let given = [&args.settings.given[..], &general.settings()].concat();
    let resolved = with_stated_rate(settings(&given, general.config.as_deref())?, &Terminal { general, report })?;
    report.warnings(&resolved.warnings);
    let config = resolved.track();
    report.warnings(config.assumed_rate().as_slice());
    let found = found(&config, args.most)?;
    report.warnings(&warnings(&found, "compared"));
    if args.answer.json {
        report::answer_json(&as_json(&found))?;
    } else {
        report::answer(&shown(&found, &config))?;
    }
    Ok(if found.cameras.iter().all(|clock| clock.lag.is_some()) { Ended::Done } else { Ended::Doubtful })
}

/// The settings with the lags that were found, as though they had been typed.
pub(crate) fn synchronised(resolved: Resolved, report: &Report) -> Result<Resolved, Error> {
    let config = resolved.track();
    let found = found(&config, MOST_APART)?;
    report.note(&shown(&found, &config));
    report.warnings(&warnings(&found, "compared and tracked"));
    let unknown = found.cameras.iter().filter(|clock| clock.lag.is_none());
    let said = |clock: &FoundClock| format!("the lag of `{}` is unknown; it is taken as declared", clock.camera);
    report.warnings(&unknown.map(said).collect::<Vec<_>>());
    let resolved = if found.common.is_some() { resolved.with_default(&TRIM, true) } else { resolved };
    match found.setting() {
        Some(lag) => Ok(resolved.with_flag(&LAG, &lag)?),
        None => Ok(resolved.without(&LAG)),
    }
}

/// What is odd about the frames that were looked at.
fn warnings(found: &FoundClocks, done: &str) -> Vec<String> {
    let common = found.common.as_ref().map(|Range { start, end }| {
        format!("the cameras have not the same frames; those that all have, {start}..{end}, are {done}")
    });
    let short = found
        .is_short
        .then(|| format!("{} frames with somebody in them are too few to tell how late cameras are", found.frames));
    common.into_iter().chain(short).collect()
}

fn found(config: &TrackConfig, most: u64) -> Result<FoundClocks, Error> {
    let (calibration, keypoints) = match (&config.calibration, &config.keypoints) {
        (Some(calibration), Some(keypoints)) => (calibration, keypoints),
        (None, None) => return Err(Error::NothingToSynchronise("calibration and no keypoints were")),
        (None, _) => return Err(Error::NothingToSynchronise("calibration was")),
        (_, None) => return Err(Error::NothingToSynchronise("keypoints were")),
    };
    let stop = interrupt::flag("the frame");
    let request = SyncRequest { most, fps: config.fps() };
    synchronise(calibration, keypoints, &config.recording, &request, || {
        if stop.load(Ordering::Relaxed) {
            return Err(sinew::Error::Interrupted("while clocks were compared; nothing was written".into()).into());
        }
        Ok(())
    })
}

/// Every camera, and the setting that puts all in step.
fn shown(found: &FoundClocks, config: &TrackConfig) -> String {
    let row = |clock: &FoundClock| (clock.camera.clone(), words(clock, config.fps));
    let rows: Vec<(String, String)> = found.cameras.iter().map(row).collect();
    let is_declared = !config.recording.lag.is_empty();
    let mend = match found.setting() {
        Some(setting) => format!("--lag {setting}\n"),
        None if found.cameras.iter().any(|clock| clock.lag.is_none()) => "nothing is known to mend\n".into(),
        None if is_declared => format!("all cameras are in step (± {:.2} frames) without `--lag`\n", widest_sd(found)),
        None => format!("all cameras are in step (± {:.2} frames)\n", widest_sd(found)),
    };
    aligned(&rows) + &mend
}

fn widest_sd(found: &FoundClocks) -> f64 {
    found.cameras.iter().filter_map(|clock| Some(clock.lag?.sd)).fold(0.0, f64::max)
}

fn words(clock: &FoundClock, fps: Option<f64>) -> String {
    let Some(lag) = clock.lag else {
        return "unknown: its lag does not show in what it shares with other cameras".into();
    };
    let side = if lag.frames < 0.0 { "early" } else { "late" };
    let frames = lag.frames.abs();
    let time =
        fps.map(|fps| format!(" ({:.1} ± {:.1} ms)", 1e3 * frames / fps, 1e3 * lag.sd / fps)).unwrap_or_default();
    let drift = clock.drift_ppm.map(|[ppm, sd]| format!(", drift {ppm:+.0} ± {sd:.0} ppm")).unwrap_or_default();
    format!("{frames:.2} ± {:.2} frames {side}{time}{drift}", lag.sd)
}

fn as_json(found: &FoundClocks) -> serde_json::Value {
    let camera = |clock: &FoundClock| {
        let [drift, drift_sd] = clock.drift_ppm.map_or([None; 2], |[drift, sd]| [Some(drift), Some(sd)]);
        json!({
            "camera": clock.camera,
            "lag_frames": clock.lag.map(|lag| lag.frames),
            "lag_sd_frames": clock.lag.map(|lag| lag.sd),
            "drift_ppm": drift,
            "drift_sd_ppm": drift_sd,
            "lag": clock.declared.to_string(),
        })
    };
    json!({
        "cameras": found.cameras.iter().map(camera).collect::<Vec<_>>(),
        "frames": found.frames,
        "lag": found.setting(),
    })
}
