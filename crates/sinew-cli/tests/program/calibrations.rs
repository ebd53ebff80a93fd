//! Calibrations of other programs: converted, inspected, tracked with, and what is said of those that are not read.

use crate::common::{QUICK, TRACK, Trial, trial};
use std::fs;

/// What a command that succeeds answers.
fn done(trial: &Trial, arguments: &[&str]) -> String {
    let output = trial.run(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", trial.printed(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// What `inspect` says of the cameras, without the first line.
fn places(trial: &Trial, file: &str) -> String {
    let shown = done(trial, &["inspect", file]);
    shown.lines().filter(|line| line.contains(" px, ")).map(|line| format!("{}\n", line.trim())).collect()
}

#[test]
fn every_format_holds_the_same_cameras() {
    let trial = trial(0.1);
    let steps = [
        (&["Calib.toml", "cameras.yml"][..], "cameras.yml: calibration of 4 cameras (OpenCV)"),
        (&["cameras.yml", "lab.qca.txt"], "lab.qca.txt: calibration of 4 cameras (Qualisys)"),
        (&["lab.qca.txt", "a.toml", "--to=freemocap"], "a.toml: calibration of 4 cameras (Anipose or FreeMoCap)"),
        (&["a.toml", "b.toml"], "b.toml: calibration of 4 cameras (Pose2Sim)"),
    ];
    for (files, first) in steps {
        done(&trial, &[&["convert"], files].concat());
        assert!(done(&trial, &["inspect", files[1]]).contains(first), "{files:?}");
        assert_eq!(places(&trial, files[1]), places(&trial, "Calib.toml"), "{files:?}");
    }
    let numbered = trial.run(&["convert", "b.toml", "camera_array.toml"]);
    insta::assert_snapshot!("convert_to_caliscope", trial.printed(&numbered));
    let renamed = (1..=4).fold(places(&trial, "Calib.toml"), |text, camera| {
        text.replace(&format!("C{camera}"), &format!("cam_{}", camera - 1))
    });
    assert_eq!(places(&trial, "camera_array.toml"), renamed);
}

#[test]
fn a_run_takes_the_calibration_of_any_program() {
    let trial = trial(0.1);
    done(&trial, &["convert", "Calib.toml", "lab.qca.txt"]);
    let run = |calibration: &str, out: &str| {
        let given = TRACK.map(|argument| if argument == "Calib.toml" { calibration } else { argument });
        done(&trial, &[&given[..], &QUICK, &["--frames=0..2", "-o", out]].concat());
        fs::read_to_string(trial.path(out).join("joints.csv")).unwrap()
    };
    let hips = |table: &str| {
        let row = table.lines().find(|line| line.contains(",RHip,")).unwrap().to_owned();
        row.split(',').skip(4).take(3).map(|cell| cell.parse().unwrap()).collect::<Vec<f64>>()
    };
    let (own, other) = (run("Calib.toml", "own"), run("lab.qca.txt", "other"));
    for (a, b) in hips(&own).iter().zip(hips(&other)) {
        assert!((a - b).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn what_cannot_be_converted_says_why() {
    let trial = trial(0.1);
    fs::write(trial.path("words.txt"), "camera 1\n1 2 3\n").unwrap();
    let fisheye = fs::read_to_string(trial.path("Calib.toml")).unwrap().replace("fisheye = false", "fisheye = true");
    let fisheye: Vec<&str> = fisheye
        .lines()
        .map(|line| if line.starts_with("distortions") { "distortions = [0, 0, 0, 0]" } else { line })
        .collect();
    fs::write(trial.path("fisheye.toml"), fisheye.join("\n")).unwrap();
    let refused = [
        &["words.txt", "a.toml"][..],
        &["fisheye.toml", "a.qca.txt"],
        &["Calib.toml", "Calib.toml"],
        &["Calib.toml", "a.xml"],
        &["Calib.toml", "a.csv"],
        &["Calib.toml", "a.toml", "--fps=60"],
        &["Calib.toml", "a.toml", "--skeleton=a.asf"],
        &["Calib.toml", "fisheye.toml"],
    ];
    let printed = refused.map(|files| {
        format!("\n$ convert {}\n{}", files.join(" "), trial.printed(&trial.run(&[&["convert"], files].concat())))
    });
    insta::assert_snapshot!("convert_refused", printed.concat());
    let given = TRACK.map(|argument| if argument == "Calib.toml" { "words.txt" } else { argument });
    insta::assert_snapshot!("track_with_words", trial.printed(&trial.run(&given)));
}
