//! Cameras whose clocks are off by whole frames: what the user reads, and what `--lag` makes of it.

use crate::common::{Trial, balancing_trial, trial};
use std::fs;
use std::path::Path;

const FRAMES: usize = 75;

/// Lets a camera show in each frame what it saw `lag` frames before; in the first frames it shows the first one.
fn delay(folder: &Path, name: impl Fn(usize) -> String, frames: usize, lag: usize) {
    // A file that is copied onto itself is emptied.
    for frame in (lag.max(1)..frames).rev().filter(|_| lag > 0) {
        fs::copy(folder.join(name(frame - lag)), folder.join(name(frame))).unwrap();
    }
}

/// The third camera is `lag` frames late.
fn late(lag: usize) -> Trial {
    let trial = trial(FRAMES as f64 / 30.0);
    delay(&trial.path("pose/C3_json"), |frame| format!("C3.{frame:04}.json"), FRAMES, lag);
    trial
}

/// Whether the number after some words is a lag, to a fifth of a frame.
fn is_late_by(printed: &str, words: &str, lag: usize) -> bool {
    let number = printed.split(words).nth(1).and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    number.is_some_and(|number| (number - lag as f64).abs() < 0.21)
}

fn inspected(trial: &Trial, more: &[&str]) -> String {
    let output = trial.run(&[&["inspect", "Calib.toml", "pose"], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn a_late_camera_is_named_and_its_frames_are_read_as_they_belong() {
    let whole = trial(FRAMES as f64 / 30.0);
    assert!(inspected(&whole, &[]).contains("calibration and keypoints fit"), "{}", inspected(&whole, &[]));
    let lag = 2;
    let (trial, flag) = (late(lag), format!("C3={lag}"));
    let printed = inspected(&trial, &[]);
    assert!(
        is_late_by(&printed, "odd: C3 is ", lag)
            && printed.contains(&format!("frames late against the other cameras; `--lag {flag}` reads")),
        "{printed}"
    );
    assert!(
        printed.contains("look at what is odd here before tracking") && !printed.contains("keypoints fit"),
        "{printed}"
    );
    let printed = trial.track_printed(&["-osilent"]);
    assert!(is_late_by(&printed, "warning: C3 is ", lag) && printed.contains(&format!("`--lag {flag}`")), "{printed}");

    let printed = inspected(&trial, &["--lag", &flag]);
    assert!(printed.contains("calibration and keypoints fit") && !printed.contains("late"), "{printed}");
    let end = FRAMES - lag;
    let frames = format!("0..{end}");
    let printed = trial.track_printed(&["--lag", &flag]);
    assert!(!printed.contains("late against"), "{printed}");
    assert!(whole.track_printed(&["--frames", &frames, "--setup-frames", &frames, "--force"]).starts_with("exit"));
    let markers = |trial: &Trial| fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    assert_eq!(markers(&trial), markers(&whole));
}

#[test]
fn a_lag_in_the_configuration_counts_and_one_of_an_unknown_camera_is_refused() {
    let trial = late(2);
    fs::write(trial.path("sinew.toml"), "lag = [\"C3=1\", \"C1=1\"]\n").unwrap();
    let printed = inspected(&trial, &[]);
    // Half of C3's lag is declared, and C1 was in time: with it C1 is early by one.
    assert!(printed.contains("`--lag C3=2`"), "{printed}");
    fs::write(trial.path("sinew.toml"), "lag = \"C3=2\"\n").unwrap();
    assert!(inspected(&trial, &[]).contains("calibration and keypoints fit"));
    let printed = |lag: &str| trial.track_printed(&["--lag", lag]);
    insta::assert_snapshot!("unknown_camera", printed("C3=2,C9=1"));
    insta::assert_snapshot!("no_whole_frames", printed("C3=half"));
    insta::assert_snapshot!("twice", printed("C3=1,C3=2"));
}

#[test]
fn lags_in_a_real_recording_are_found() {
    let Some(data) = sinew_tests::data::shared("pose2sim_single") else { return };
    let source = data.join("T01_BalancingTrial/pose");
    for (camera, lag) in [(3, 0), (3, 1), (1, 2)] {
        let trial = Trial { folder: tempfile::tempdir().unwrap() };
        fs::copy(data.join("Calib.toml"), trial.path("Calib.toml")).unwrap();
        for number in 1..=4 {
            let to = trial.path(&format!("pose/cam0{number}_json"));
            fs::create_dir_all(&to).unwrap();
            for frame in 0..100 {
                let name = format!("cam0{number}.{frame:04}.json");
                // Copies of read-only files would be read-only.
                fs::write(to.join(&name), fs::read(source.join(format!("cam0{number}_json")).join(&name)).unwrap())
                    .unwrap();
            }
        }
        let folder = trial.path(&format!("pose/cam0{camera}_json"));
        delay(&folder, |frame| format!("cam0{camera}.{frame:04}.json"), 100, lag);
        let (printed, flag) = (inspected(&trial, &[]), format!("--lag cam_0{camera}={lag}`"));
        assert_eq!(printed.contains(&flag), lag > 0, "{printed}");
        assert_eq!(printed.contains("calibration and keypoints fit"), lag == 0, "{printed}");
        let mended = inspected(&trial, &["--lag", &format!("cam_0{camera}={lag}")]);
        assert!(mended.contains("calibration and keypoints fit"), "{mended}");
    }
}

/// His keypoints stand on a grid of pixels and hardly move: what looks like a lag does not follow when a camera is moved in time.
#[test]
fn a_bystander_makes_no_camera_early() {
    let Some([calibration, keypoints, layout]) = balancing_trial() else { return };
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let of_recording = ["track", &calibration, &keypoints, &layout];
    let quick = ["--fps", "60", "--person", "2", "--updates", "12", "--burn-in", "4", "--patience", "1", "-o", "out"];
    let said = trial.printed(&trial.run(&[&of_recording[..], &quick].concat()));
    assert!(trial.path("out/joints.csv").is_file() && !said.contains("against the other cameras"), "{said}");
}
