//! `sinew simulate --people N`: people whose ways cross, before cameras around them.
//!
//! Keypoints and truth only: masks and pictures are of one person.

use super::args::{General, SimulateArgs};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use super::simulated_files::{CALIBRATION, FOLDERS, README, WALK_S, cameras, is_of_recording, track_command};
use super::table::aligned;
use super::terminal::Terminal;
use serde_json::json;
use sinew::config::TrackConfig;
use sinew::formats::calib_toml;
use sinew::run::claimed::claimed;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording};
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::write_trc;
use sinew_simulate::ring::Ring;
use std::path::Path;

/// Runs the command for several people.
pub(crate) fn run(
    args: &SimulateArgs,
    config: &TrackConfig,
    general: &General,
    report: &Report,
) -> Result<Ended, Error> {
    let claim = claimed(config, &[], &Terminal { general, report })?;
    let size = args.size.map(f64::from);
    let ring = Ring { cameras: args.cameras, image_size_px: size, ..Ring::default() };
    let keypoints = DetectorNoise { offset_px: 0.0, ..DetectorNoise::DETECTOR_LIKE.in_rows(size[1]) };
    let crowd = Crowd {
        people: args.people,
        duration_s: args.duration.unwrap_or(WALK_S),
        rate_hz: args.fps,
        ring,
        calibration: CalibrationError::NONE,
        noise: CrowdNoise { keypoints, ..CrowdNoise::DETECTOR_LIKE },
    };
    let seed = config.seed;
    let recording = CrowdRecording::new(&crowd, seed).map_err(Error::Scene)?;
    let staged = claim.staged()?;
    for (name, text) in recording.keypoint_files() {
        staged.write(&format!("{}/{name}", FOLDERS[0]), text.as_bytes())?;
    }
    staged.write(CALIBRATION, calib_toml::write(&recording.cameras).as_bytes())?;
    for (person, truth) in (1..).zip(&recording.truth) {
        let name = truth_name(person);
        let mut bytes = vec![];
        write_trc(&mut bytes, &name, truth, args.fps).map_err(sinew::Error::io("write", &name))?;
        staged.write(&name, &bytes)?;
    }
    staged.write(README, readme(args, &config.out, seed).as_bytes())?;
    staged.finish(is_of_recording)?;
    drop(claim);
    let frames = recording.truth.first().map_or(0, |one| one.frames.len());
    let out = config.out.display().to_string();
    if args.answer.json {
        report::answer_json(&json!({
            "people": args.people, "frames": frames, "cameras": args.cameras, "rate_hz": args.fps, "seed": seed, "out": out,
        }))?;
    } else {
        let rows = [
            ("people".to_owned(), args.people.to_string()),
            ("frames".to_owned(), format!("{frames} at {} per second, {}", args.fps, cameras(args.cameras))),
            ("written".to_owned(), out.clone()),
        ];
        report::answer(&format!("{}\nNext:\n  {}\n", aligned(&rows), next_command(&out, args)))?;
    }
    Ok(Ended::Done)
}

/// The command that tracks everybody; one of them where one camera cannot tell people apart.
fn next_command(folder: &str, args: &SimulateArgs) -> String {
    let command = track_command(folder, args.fps);
    if args.cameras > 1 { command } else { format!("{command} --people 1") }
}

/// Name of the file with a person's true positions.
fn truth_name(person: usize) -> String {
    format!("truth_{person:02}.trc")
}

fn readme(args: &SimulateArgs, out: &Path, seed: u64) -> String {
    let folder = out.file_name().unwrap_or_default().to_string_lossy();
    let line = |person| format!("{}   where the points of one person truly are\n", truth_name(person));
    let truth: String = (1..=args.people).map(line).collect();
    let whom = if args.cameras > 1 { "everybody" } else { "the most complete one at the start" };
    format!(
        "A synthetic recording by sinew {}: {} people whose ways cross, {}, seed {seed}.\n\n\
         {CALIBRATION}     cameras\n\
         keypoints/     what a detector with errors found, BODY_25B: people hide, merge and exchange limbs\n\
         {truth}\n\
         Results number people in the order of coming, which need not be the order of these files.\n\n\
         To track {whom}, from the folder above:\n  {}\n",
        env!("CARGO_PKG_VERSION"),
        args.people,
        cameras(args.cameras),
        next_command(&folder, args),
    )
}
