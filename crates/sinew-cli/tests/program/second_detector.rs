//! Two detectors on the same videos: hips, which they see centimetres apart.

use crate::common::{QUICK, Trial, column};
use std::fs;
use std::path::Path;

/// Mean and standard deviation of each coordinate of both hips and their middle, frame after frame.
fn hips(data: &Path, keypoints: &str, layout: &str) -> Vec<[f64; 2]> {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let file = |flag: &str, name: &str| format!("--{flag}={}", data.join(name).display());
    let inputs = [file("calibration", "pose2sim_single/Calib.toml"), file("keypoints", keypoints)];
    let rest = ["track", &inputs[0], &inputs[1], layout, "--fps=60", "--people=1", "-oout", "--no-progress"];
    let output = trial.run(&[&rest[..], &QUICK].concat());
    assert!(output.status.success(), "{}", trial.printed(&output));
    let table = fs::read(trial.path("out/joints.csv")).unwrap();
    let numbers = |name: &str| -> Vec<f64> { column(&table, name).iter().map(|x| x.parse().unwrap()).collect() };
    let axes = ["x", "y", "z"].map(|axis| [numbers(&format!("{axis}_mean_m")), numbers(&format!("{axis}_sd_m"))]);
    let rows = column(&table, "joint").into_iter().enumerate().filter(|(_, joint)| joint.ends_with("Hip"));
    rows.flat_map(|(row, _)| axes.each_ref().map(|[mean, sd]| [mean[row], sd[row]])).collect()
}

/// MediaPipe sees hips 3 cm lower than OpenPose. Where the joints are, both runs say with intervals that hold what is between them.
#[test]
fn hips_of_two_detectors_agree() {
    let [Some(one), Some(_)] = ["pose2sim_single", "pose2sim_second_detector"].map(sinew_tests::data::shared) else {
        return;
    };
    let data = one.parent().unwrap();
    let first = hips(data, "pose2sim_single/T01_BalancingTrial/pose", "--layout=BODY_25B");
    let second = hips(data, "pose2sim_second_detector", "--layout=MEDIAPIPE_33");
    assert_eq!(first.len(), second.len());
    // A frame of the second detector is one later; three points of three coordinates.
    let pairs = second[9..].iter().zip(&first);
    let apart: Vec<f64> = pairs.map(|([a, a_sd], [b, b_sd])| (a - b).abs() / a_sd.hypot(*b_sd)).collect();
    let inside = apart.iter().filter(|apart| **apart < 1.645).count() as f64 / apart.len() as f64;
    // Six biases: at most two are outside in 98 of 100 recordings, which is 0.67. The bound lies between 0.72, before hips had places of their own width, and the 0.80 to 0.94 of five seeds.
    assert!((0.77..0.99).contains(&inside), "{inside:.3} of the coordinates lie inside");
}
