//! What the user reads about paths that lead nowhere, or to something else than was expected.

use crate::common::{Trial, trial};
use std::fs;

fn tracked(trial: &Trial, calibration: &str, keypoints: &str) -> String {
    trial.printed(&trial.run(&["track", "--calibration", calibration, "--keypoints", keypoints]))
}

fn masked(trial: &Trial, masks: &str) -> String {
    let given = ["track", "--calibration", "Calib.toml", "--method=annealed", "--init=keypoints", "--keypoints=pose"];
    trial.printed(&trial.run(&[&given[..], &["--silhouettes", masks]].concat()))
}

#[test]
fn paths_that_are_not_there() {
    let trial = trial(0.1);
    fs::create_dir_all(trial.path("study/trial1/pose")).unwrap();
    insta::assert_snapshot!("one_letter", tracked(&trial, "Calb.toml", "pose"));
    insta::assert_snapshot!("without_extension", tracked(&trial, "calib", "pose"));
    insta::assert_snapshot!("in_a_folder", tracked(&trial, "Calib.toml", "study/trail1/pose"));
    insta::assert_snapshot!("nothing_like_it", tracked(&trial, "study/camera.toml", "pose"));
    insta::assert_snapshot!("below_a_file", tracked(&trial, "Calib.toml", "Calib.toml/pose"));
    insta::assert_snapshot!("inspect", trial.printed(&trial.run(&["inspect", "Calib.tml"])));
}

#[test]
fn folders_for_files_and_files_for_folders() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("calibrations")).unwrap();
    fs::copy(trial.path("Calib.toml"), trial.path("calibrations/monday.toml")).unwrap();
    insta::assert_snapshot!("folder_of_calibrations", tracked(&trial, "calibrations", "pose"));
    insta::assert_snapshot!("folder_of_keypoints", tracked(&trial, "pose", "pose"));
    insta::assert_snapshot!("file_of_keypoints", tracked(&trial, "Calib.toml", "pose/C1_json/C1.0000.json"));
    insta::assert_snapshot!("file_of_masks", masked(&trial, "Calib.toml"));
}

#[test]
fn videos() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("videos")).unwrap();
    for camera in 1..=4 {
        fs::write(trial.path(&format!("videos/C{camera}")), b"\0\0\0\x20ftypisom").unwrap();
    }
    fs::rename(trial.path("videos/C1"), trial.path("videos/C1.avi")).unwrap();
    insta::assert_snapshot!("videos_for_keypoints", tracked(&trial, "Calib.toml", "videos"));
    insta::assert_snapshot!("videos_for_masks", masked(&trial, "videos"));
    insta::assert_snapshot!("video_for_keypoints", tracked(&trial, "Calib.toml", "videos/C2"));
    insta::assert_snapshot!("inspect_videos", trial.printed(&trial.run(&["inspect", "videos"])));
    insta::assert_snapshot!("inspect_video", trial.printed(&trial.run(&["inspect", "videos/C1.avi"])));
}

/// The beginning of a calibration of Qualisys.
const QUALISYS: &str = r#"<?xml version='1.0' encoding='ASCII'?>
<calibration created="sometimes ago" qtm-version="none" type="regular" wandLength="none">
  <cameras>
    <camera active="1" model="none" serial="cam_01" viewrotation="0">
      <fov_marker bottom="1919" left="0" right="1087" top="0"/>
"#;

#[test]
fn calibrations_of_qualisys_that_are_cut() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("qualisys")).unwrap();
    fs::write(trial.path("Calib.qca.txt"), QUALISYS).unwrap();
    insta::assert_snapshot!("qualisys", tracked(&trial, "Calib.qca.txt", "pose"));
    insta::assert_snapshot!("inspect_qualisys", trial.printed(&trial.run(&["inspect", "Calib.qca.txt"])));
}
