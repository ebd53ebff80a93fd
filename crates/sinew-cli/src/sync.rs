//! `sinew sync`: how late cameras are against each other; and `sinew track --sync`, which reads the recording with that.

use super::args::{General, MOST_APART, SyncArgs};
use super::ended::Ended;
use super::error::Error;
use super::interrupt;
use super::report::{self, Report};
use super::table::aligned;
use serde_json::json;
use sinew::config::common::LAG;
use sinew::config::{Resolved, TrackConfig};
use sinew::run::settings::settings;
use sinew_analysis::sync::{FoundClock, FoundClocks, SyncRequest, synchronise};
use std::sync::atomic::Ordering;

/// Runs the command.
pub(crate) fn run(args: &SyncArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let given = [&args.settings.given[..], &general.settings()].concat();
    let resolved = settings(&given, general.config.as_deref())?;
    report.warnings(&resolved.warnings);
    let config = resolved.track();
    report.warnings(config.assumed_rate().as_slice());
    let found = found(&config, args.most)?;
    if args.answer.json {
        report::answer_json(&as_json(&found))?;
    } else {
        report::answer(&shown(&found, config.fps))?;
    }
    Ok(if found.cameras.iter().all(|clock| clock.lag.is_some()) { Ended::Done } else { Ended::Doubtful })
}

/// The settings with the lags that were found, as though they had been typed.
pub(crate) fn synchronised(resolved: Resolved, report: &Report) -> Result<Resolved, Error> {
    let config = resolved.track();
    let found = found(&config, MOST_APART)?;
    report.note(&shown(&found, config.fps));
    let unknown = found.cameras.iter().filter(|clock| clock.lag.is_none());
    let said = |clock: &FoundClock| format!("the lag of `{}` is unknown; it is taken as declared", clock.camera);
    report.warnings(&unknown.map(said).collect::<Vec<_>>());
    match found.setting() {
        Some(lag) => Ok(resolved.with_flag(&LAG, &lag)?),
        None => Ok(resolved),
    }
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
fn shown(found: &FoundClocks, fps: Option<f64>) -> String {
    let rows: Vec<(String, String)> =
        found.cameras.iter().map(|clock| (clock.camera.clone(), words(clock, fps))).collect();
    let mend = match found.setting() {
        Some(setting) => format!("--lag {setting}\n"),
        None if found.cameras.iter().any(|clock| clock.lag.is_none()) => "nothing is known to mend\n".into(),
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
