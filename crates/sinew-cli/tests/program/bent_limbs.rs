//! Which way knees and elbows bend after they were straight.

use crate::common::{Trial, column};
use std::fs;

/// Chains that all turned an arm the wrong way while it hung straight do not come back by themselves: without a half turn this elbow bends backward by 40°.
#[test]
fn an_arm_that_turned_the_wrong_way_turns_back() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let demo = trial.run(&["demo", "--seed", "3102", "-o", "out"]);
    assert!(demo.status.success(), "{}", trial.printed(&demo));
    let states = fs::read_to_string(trial.path("out/state.csv")).unwrap();
    let elbows = states.lines().filter(|line| line.contains("_forearm.rx"));
    let bends: Vec<f64> = elbows.map(|line| line.split(',').nth(5).unwrap().parse::<f64>().unwrap()).collect();
    let least = bends.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(bends.len() == 240 && least > -20.0, "{least}°");
    let frames = fs::read(trial.path("out/frames.csv")).unwrap();
    assert_eq!(column(&frames, "restarted").iter().filter(|restarted| *restarted == "1").count(), 2);
}

/// Keypoints of COCO: the first 17 of BODY_25B.
const COCO: usize = 17;

/// A walker who stands for a second first, with straight knees that show no direction.
#[test]
fn knees_bend_backwards_where_keypoints_end_at_the_ankles() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let simulated = trial.run(&["simulate", "--duration", "6", "--seed", "11", "--images", "none", "-o", "walk"]);
    assert!(simulated.status.success(), "{}", trial.printed(&simulated));
    for camera in fs::read_dir(trial.path("walk/keypoints")).unwrap() {
        for file in fs::read_dir(camera.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            let mut read: serde_json::Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            for person in read["people"].as_array_mut().unwrap() {
                person["pose_keypoints_2d"].as_array_mut().unwrap().truncate(3 * COCO);
            }
            fs::write(&path, read.to_string()).unwrap();
        }
    }
    let recording = ["--calibration", "walk/Calib.toml", "--keypoints", "walk/keypoints", "--layout", "COCO_17"];
    trial.run(&[&["track", "--fps", "30", "--people", "1", "--frames", "0..80", "-o", "out"], &recording[..]].concat());
    let angles = fs::read_to_string(trial.path("out/angles.csv")).unwrap();
    let knees = angles.lines().filter(|line| line.contains("knee_angle"));
    let bends: Vec<f64> = knees.map(|line| line.split(',').nth(4).unwrap().parse().unwrap()).collect();
    let (least, most) = bends.iter().fold((0.0_f64, 0.0_f64), |(a, b), x| (a.min(*x), b.max(*x)));
    assert!(bends.len() == 160 && least > -20.0 && most > 40.0, "{least} to {most}");
}
