//! `sinew sync` and `sinew track --sync`: cameras that are late by whole frames and by parts of one.

use crate::common::{Trial, trial};
use sinew_simulate::detector::{DetectorNoise, detect};
use sinew_simulate::recording::{Script, SyntheticRecording, body_25b, keypoint_files};
use std::fs;

const SECONDS: f64 = 3.0;

/// A walker whom four cameras see, each as late as its clock says.
fn late(lags: [f64; 4]) -> Trial {
    let recording = SyntheticRecording::new(&Script { duration_s: SECONDS, ..Script::default() }, 1).unwrap();
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    fs::write(trial.path("Calib.toml"), recording.calibration_toml()).unwrap();
    let stage = sinew::core::random::Stage::new(5, "late cameras");
    let cameras = (&recording.cameras[..], &lags[..]);
    let seen = detect(&recording.truth, &body_25b(), cameras, &DetectorNoise::DETECTOR_LIKE, stage);
    for (name, text) in keypoint_files(&recording.cameras, &seen.keypoints) {
        let path = trial.path(&format!("pose/{name}"));
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    trial
}

const RECORDING: [&str; 4] = ["--calibration", "Calib.toml", "--keypoints", "pose"];

fn synchronised(trial: &Trial, more: &[&str]) -> (Option<i32>, String) {
    let output = trial.run(&[&["sync"], &RECORDING[..], more].concat());
    (output.status.code(), String::from_utf8(output.stdout.clone()).unwrap() + &trial.printed(&output))
}

#[test]
fn a_camera_that_is_late_by_part_of_a_frame_is_found_and_read_in_time() {
    let trial = late([0.0, 0.0, 1.6, 0.0]);
    let output = trial.run(&[&["sync", "--json"], &RECORDING[..]].concat());
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |camera: usize, name: &str| found["cameras"][camera][name].as_f64().unwrap();
    for camera in 0..4 {
        let truth = if camera == 2 { 1.6 } else { 0.0 };
        let (lag, sd) = (number(camera, "lag_frames"), number(camera, "lag_sd_frames"));
        assert!((lag - truth).abs() < 0.25 && sd < 0.15, "{found}");
    }
    let flag = found["lag"].as_str().unwrap();
    assert!(flag.starts_with("C3=1."), "{flag}");

    let (_, printed) = synchronised(&trial, &["--fps", "30"]);
    assert!(printed.contains("frames late (5") && printed.contains(&format!("--lag {flag}")), "{printed}");
    // What is declared is taken away, and found again.
    let (_, again) = synchronised(&trial, &["--lag", flag]);
    assert!(again.contains("C3  1."), "{again}");

    let tracked = trial.track_printed(&["--sync"]);
    assert!(tracked.contains(&format!("--lag {flag}")), "{tracked}");
    let markers = || fs::read(trial.path("out/markers.trc")).unwrap();
    let with_sync = markers();
    trial.track_printed(&["--lag", flag, "--force"]);
    assert!(markers() == with_sync);
    let settings = fs::read_to_string(trial.path("out/config.toml")).unwrap();
    assert!(settings.contains(&format!("\"{flag}\"")), "{settings}");
    trial.track_printed(&["--lag", "C3=-4", "--force"]);
    assert!(markers() != with_sync);
}

#[test]
fn a_clock_that_drifts_is_read_at_its_own_rate() {
    let trial = late([0.0; 4]);
    // Frame 80 is the 80.4th of a camera that falls behind by 5000 in a million.
    let printed = trial.track_printed(&["--lag", "C2=0+5000ppm", "--frames", "0..80"]);
    assert!(printed.starts_with("exit"), "{printed}");
    let at = |trial: &Trial| fs::read_to_string(trial.path("out/frames.csv")).unwrap().lines().count();
    assert_eq!(at(&trial), 81);
}

#[test]
fn recordings_without_clocks_to_compare_are_refused() {
    let trial = late([0.0; 4]);
    assert!(synchronised(&trial, &["--fps", "30"]).1.contains("all cameras are in step"));
    insta::assert_snapshot!("one_camera", synchronised(&trial, &["--cameras", "C1"]).1);
    insta::assert_snapshot!("no_keypoints", trial.printed(&trial.run(&["sync", "--calibration", "Calib.toml"])));
    // Nobody moves in the first second.
    let (code, printed) = synchronised(&trial, &["--frames", "0..28"]);
    assert!(code == Some(4) && printed.contains("unknown: its lag does not show"), "{code:?} {printed}");
}

#[test]
fn keypoints_of_other_formats_are_interpolated_too() {
    let whole = trial(1.0);
    let printed = whole.track_printed(&["--lag", "C1=0.5,C2=0.5,C3=0.5,C4=0.5"]);
    assert!(printed.starts_with("exit"), "{printed}");
    // All are late alike: half a frame at the ends is not there, and the rest has numbers of the recording.
    let frames = fs::read_to_string(whole.path("out/frames.csv")).unwrap();
    assert_eq!(frames.lines().nth(1).unwrap().split(',').next(), Some("0"));
    assert_eq!(frames.lines().count(), 30);
}

/// Three people whose ways cross before cameras that are in step, and before one that is five frames late.
#[test]
fn clocks_are_found_from_everybody_of_a_crowd() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let simulated = trial.run(&["simulate", "--people", "3", "--duration", "3", "-o", "crowd"]);
    assert!(simulated.status.success(), "{}", trial.printed(&simulated));
    let recording = ["--calibration", "crowd/Calib.toml", "--keypoints", "crowd/keypoints", "--layout", "BODY_25B"];
    let found = |trial: &Trial| {
        let output = trial.run(&[&["sync", "--json", "--fps", "30"], &recording[..]].concat());
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        [0, 1, 2, 3].map(|camera| found["cameras"][camera]["lag_frames"].as_f64().unwrap())
    };
    let in_step = found(&trial);
    assert!(in_step.iter().all(|lag| lag.abs() < 0.2), "{in_step:?}");
    let folder = trial.path("crowd/keypoints/C2_json");
    let mut names: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    for (number, path) in names.iter().enumerate().rev() {
        fs::rename(path, folder.join(format!("C2.{:06}.json", number + 5))).unwrap();
    }
    let late = found(&trial);
    assert!((late[1] - 5.0).abs() < 0.3 && [0, 2, 3].iter().all(|c| late[*c].abs() < 0.2), "{late:?}");
}
