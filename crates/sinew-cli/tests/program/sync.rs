//! `sinew sync` and `sinew track --sync`: cameras that are late by whole frames and by parts of one.

use crate::common::{Trial, balancing_trial, trial};
use sinew::formats::openpose::Keypoint;
use sinew_simulate::detector::{DetectorNoise, detect};
use sinew_simulate::recording::{Script, SyntheticRecording, body_25b, keypoint_files};
use std::fmt::Write as _;
use std::fs;

const SECONDS: f64 = 3.0;

/// A walker whom four cameras see, each as late as its clock says.
fn late(lags: [f64; 4]) -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let (recording, keypoints) = seen(lags);
    fs::write(trial.path("Calib.toml"), recording.calibration_toml()).unwrap();
    for (name, text) in keypoint_files(&recording.cameras, &keypoints) {
        let path = trial.path(&format!("pose/{name}"));
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    trial
}

/// The same walker, with the keypoints by camera, frame and point.
fn seen(lags: [f64; 4]) -> (SyntheticRecording, Vec<Vec<Vec<Option<Keypoint>>>>) {
    let recording = SyntheticRecording::new(&Script { duration_s: SECONDS, ..Script::default() }, 1).unwrap();
    let stage = sinew::core::random::Stage::new(5, "late cameras");
    let cameras = (&recording.cameras[..], &lags[..]);
    let seen = detect(&recording.truth, &body_25b(), cameras, &DetectorNoise::DETECTOR_LIKE, stage);
    (recording, seen.keypoints)
}

/// Points of MediaPipe by the names of BODY_25B.
const POINTS: [(&str, usize); 13] = [
    ("Nose", 0),
    ("LShoulder", 11),
    ("RShoulder", 12),
    ("LElbow", 13),
    ("RElbow", 14),
    ("LWrist", 15),
    ("RWrist", 16),
    ("LHip", 23),
    ("RHip", 24),
    ("LKnee", 25),
    ("RKnee", 26),
    ("LAnkle", 27),
    ("RAnkle", 28),
];

/// Times that stand in the keypoints say how long a frame is.
#[test]
fn a_lag_in_milliseconds_is_of_the_rate_that_the_file_states() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let (recording, keypoints) = seen([0.0, 0.0, 1.6, 0.0]);
    fs::write(trial.path("Calib.toml"), recording.calibration_toml()).unwrap();
    let mut text = "sync_index,cam_id,frame_index,frame_time,point_id,img_loc_x,img_loc_y\n".to_owned();
    let layout = body_25b();
    for (camera, frames) in keypoints.iter().enumerate() {
        for (frame, points) in frames.iter().enumerate() {
            for (name, id) in POINTS {
                let Some(point) = points[layout.index(name).unwrap()] else { continue };
                let (camera, time) = (camera + 1, frame as f64 / 50.0);
                let _ = writeln!(text, "{frame},{camera},{frame},{time},{id},{},{}", point.x, point.y);
            }
        }
    }
    fs::write(trial.path("xy.csv"), text).unwrap();
    let output = trial.run(&["sync", "--calibration", "Calib.toml", "--keypoints", "xy.csv"]);
    let answer = String::from_utf8(output.stdout.clone()).unwrap();
    let said = trial.printed(&output);
    assert!(said.contains("50 frames per second, by the times in xy.csv"), "{said}");
    let line = answer.lines().find(|line| line.starts_with("C3")).unwrap_or_else(|| panic!("{answer} {said}"));
    let number = |text: &str| text.split_whitespace().next().unwrap().parse::<f64>().unwrap();
    let (frames, ms) = (number(&line[2..]), number(line.split('(').nth(1).unwrap()));
    assert!((frames - 1.6).abs() < 0.4 && (ms - frames * 1000.0 / 50.0).abs() < 0.2, "{line}");
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

    // Sizes and noise are of the first frames, which is quicker; clocks are of all.
    let few = "--setup-frames=0..20";
    let tracked = trial.track_printed(&["--sync", few]);
    assert!(tracked.contains(&format!("--lag {flag}")), "{tracked}");
    let markers = || fs::read(trial.path("out/markers.trc")).unwrap();
    let with_sync = markers();
    trial.track_printed(&["--lag", flag, "--force", few]);
    assert!(markers() == with_sync);
    let settings = fs::read_to_string(trial.path("out/config.toml")).unwrap();
    assert!(settings.contains(&format!("\"{flag}\"")), "{settings}");
    trial.track_printed(&["--lag", "C3=-4", "--force", few]);
    assert!(markers() != with_sync);
}

#[test]
fn a_clock_that_drifts_is_read_at_its_own_rate() {
    let trial = late([0.0; 4]);
    // Frame 80 is the 80.4th of a camera that falls behind by 5000 in a million.
    let printed = trial.track_printed(&["--lag", "C2=0+5000ppm", "--frames", "0..80", "--setup-frames", "0..20"]);
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
    // Nobody moves in the first second, and in so few frames nobody can know.
    for (frames, seen) in [("0..28", 28), ("0..50", 50)] {
        let (code, printed) = synchronised(&trial, &["--frames", frames, "--fps", "30"]);
        assert!(code == Some(4) && printed.contains("unknown: its lag does not show"), "{code:?} {printed}");
        let said = format!("{seen} frames with somebody in them are too few to tell how late cameras are");
        assert!(printed.contains(&said) && !printed.contains("--lag"), "{printed}");
    }
}

/// Nothing is to be declared of cameras that are in step, whatever was.
#[test]
fn a_lag_that_was_declared_in_vain_is_taken_back() {
    let trial = late([0.0; 4]);
    let (_, printed) = synchronised(&trial, &["--lag", "C2=2", "--fps", "30"]);
    assert!(printed.contains("all cameras are in step") && printed.contains("without `--lag`"), "{printed}");
    let lag = |more: &[&str]| {
        let output = trial.track(&[&["--lag", "C2=2", "--print-config", "--json"], more].concat());
        let settings: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        settings["lag"]["value"].to_string()
    };
    assert_eq!([lag(&[]), lag(&["--sync"])], ["[\"C2=2\"]", "null"]);
}

/// A camera that stopped before the others: what all have is compared and tracked, and that is said.
#[test]
fn cameras_that_end_apart_are_compared_in_what_they_share() {
    let trial = late([0.0, 0.0, 2.0, 0.0]);
    for frame in 85..90 {
        fs::remove_file(trial.keypoints(2, frame)).unwrap();
    }
    let said = "the cameras have not the same frames; those that all have, 0..85, are compared";
    let (_, printed) = synchronised(&trial, &["--fps", "30"]);
    assert!(printed.contains(said) && printed.contains("--lag C3=2"), "{printed}");
    let tracked = trial.track_printed(&["--sync", "--setup-frames=0..20"]);
    assert!(tracked.contains(said) && tracked.contains("--lag C3=2"), "{tracked}");
    // A camera that is late by two frames shows the last two in frames that the others have not.
    let frames = fs::read_to_string(trial.path("out/frames.csv")).unwrap();
    assert_eq!(frames.lines().count(), 1 + 85, "{tracked}");
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
    let inspect = ["inspect", "--fps", "30", "--trim", "crowd/Calib.toml", "crowd/keypoints"];
    let inspected = String::from_utf8(trial.run(&inspect).stdout).unwrap();
    assert!(inspected.contains("`--lag C2=5`"), "{inspected}");
}

/// That all cameras are in step is as sure as the one of which least is known.
#[test]
fn cameras_are_in_step_as_surely_as_the_least_known() {
    let Some([calibration, keypoints, layout]) = balancing_trial() else { return };
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let output = trial.run(&["sync", "--fps", "60", &calibration, &keypoints, &layout]);
    let said = String::from_utf8(output.stdout).unwrap();
    let spread = |line: &str| line.split("± ").nth(1)?.split(' ').next()?.parse::<f64>().ok();
    let spreads: Vec<f64> = said.lines().filter_map(spread).collect();
    let (all, cameras) = spreads.split_last().unwrap();
    assert!(cameras.len() == 4 && said.contains("all cameras are in step"), "{said}");
    let [least, most] = [f64::min, f64::max].map(|of| cameras.iter().copied().reduce(of).unwrap());
    assert!(least < most && *all == most, "{said}");
}
