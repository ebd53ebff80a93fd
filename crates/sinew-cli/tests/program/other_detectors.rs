//! Recordings of detectors that write one file a camera, and what is said of odd ones.

use crate::common::{Trial, trial};
use serde_json::{Value, json};
use std::fs;

/// Frames of the recording.
const FRAMES: usize = 12;

/// Entries of COCO results of a camera: the people of its files, with ids that begin at `first`, without some frames.
fn coco(trial: &Trial, camera: usize, first: usize, leave_out: &[usize]) -> String {
    let entry = |frame: usize| {
        let text = fs::read_to_string(trial.keypoints(camera, frame)).unwrap();
        let file: Value = serde_json::from_str(&text).unwrap();
        let keypoints = &file["people"][0]["pose_keypoints_2d"];
        json!({"image_id": first + frame, "category_id": 1, "keypoints": keypoints, "score": 2.5})
    };
    let seen = (0..FRAMES).filter(|frame| !leave_out.contains(frame));
    Value::from(seen.map(entry).collect::<Vec<Value>>()).to_string()
}

/// A recording whose four cameras have COCO results, the first of them all frames.
fn results(first: impl Fn(usize) -> usize, leave_out: impl Fn(usize) -> Vec<usize>) -> Trial {
    let trial = trial(FRAMES as f64 / 30.0);
    let texts = [1, 2, 3, 4].map(|camera| coco(&trial, camera, first(camera), &leave_out(camera)));
    fs::remove_dir_all(trial.path("pose")).unwrap();
    fs::create_dir(trial.path("pose")).unwrap();
    for (camera, text) in (1..).zip(texts) {
        fs::write(trial.path(&format!("pose/C{camera}.json")), text).unwrap();
    }
    trial
}

fn inspected(trial: &Trial, arguments: &[&str]) -> String {
    let output = trial.run(&[&["inspect"], arguments].concat());
    format!("{}{}", String::from_utf8_lossy(&output.stdout), trial.printed(&output))
}

#[test]
fn cameras_that_see_nobody_at_first_or_ever_are_tracked() {
    let trial = results(
        |_| 0,
        |camera| match camera {
            2 => vec![0, 1, 7, 11],
            4 => (0..FRAMES).collect(),
            _ => vec![],
        },
    );
    assert_eq!(fs::read_to_string(trial.path("pose/C4.json")).unwrap(), "[]");
    let printed = trial.track_printed(&["--people=1"]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    for warning in ["camera C2: 4 of 12 frames have no person (first: 0)", "camera C4: 12 of 12 frames have no person"]
    {
        assert!(printed.contains(warning), "{printed}");
    }
    assert!(!printed.contains("lacks frames") && !printed.contains("no keypoints for"), "{printed}");
    let shown = inspected(&trial, &["pose", "--layout", "BODY_25B"]);
    assert!(shown.contains("8 frames in one file, frames 0..12, 0 to 1 people, pixels"), "{shown}");
    assert!(shown.contains("odd: camera C4: 12 of 12 frames have no person") && !shown.contains("--trim"), "{shown}");
}

#[test]
fn ids_that_run_on_from_camera_to_camera_get_an_advice_that_helps() {
    let trial = results(|camera| 3000 * (camera - 1), |_| vec![]);
    let printed = trial.track_printed(&["--people=1"]);
    assert!(printed.contains("error: C1 has 12 frames, C2 has 12"), "{printed}");
    assert!(printed.contains("`--trim` would leave nothing") && printed.contains("`--lag C2=3000`"), "{printed}");
    let shown = inspected(&trial, &["pose", "--layout", "BODY_25B"]);
    assert!(shown.contains("odd: C1 has 12 frames, C2 has 12"), "{shown}");
    let mended = trial.track_printed(&["--people=1", "--lag=C2=3000,C3=6000,C4=9000"]);
    assert!(mended.starts_with("exit 0"), "{mended}");
}

#[test]
fn files_of_unknown_kinds_are_called_so() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("mine")).unwrap();
    for camera in 1..=4 {
        fs::write(trial.path(&format!("mine/C{camera}.json")), r#"{"joints": [[1, 2], [3, 4]]}"#).unwrap();
    }
    let known = "is no keypoint file of a known kind; known: Caliscope, DeepLabCut, MMPose, RTMLib, AlphaPose, COCO results, MediaPipe; OpenPose and MMPose with a file a frame";
    for given in ["mine", "mine/C1.json"] {
        let shown = inspected(&trial, &[given]);
        assert!(shown.contains(&format!("error: `mine/C1.json` {known}")), "{shown}");
        let tracked = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", given]);
        assert!(trial.printed(&tracked).contains(&format!("error: `mine/C1.json` {known}")), "{given}");
    }
    let frame = inspected(&trial, &["pose/C1_json/C1.0000.json"]);
    assert!(frame.contains("is a file; expected a folder of keypoints"), "{frame}");
}

#[test]
fn shares_of_the_image_are_called_so() {
    let trial = trial(0.1);
    let landmark = json!({"x": 0.25, "y": 0.5, "z": 0.0, "visibility": 0.9});
    let frame = json!({"landmark": vec![landmark; 33]});
    fs::write(trial.path("C1.json"), json!([frame, frame, {}]).to_string()).unwrap();
    let shown = inspected(&trial, &["C1.json"]);
    assert!(shown.contains("0 to 1 people, shares of the image 0.25 to 0.25 by 0.50 to 0.50"), "{shown}");
}

#[test]
fn times_say_the_frame_rate_where_no_setting_does() {
    let trial = trial(0.1);
    let rows = (0..3).map(|frame| format!("{frame},1,{frame},{},11,101,51\n", 7.0 + f64::from(frame) / 24.97));
    let header = "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y\n";
    fs::write(trial.path("xy.csv"), rows.fold(header.to_owned(), |text, row| text + &row)).unwrap();
    let given = ["track", "--calibration", "Calib.toml", "--keypoints", "xy.csv", "--print-config"];
    let output = trial.run(&given);
    let printed = format!("{}{}", String::from_utf8_lossy(&output.stdout), trial.printed(&output));
    assert!(printed.contains("25 frames per second, by the times in xy.csv (`--fps`)"), "{printed}");
    let stated = trial.run(&[&given[..], &["--fps=60"]].concat());
    assert!(!trial.printed(&stated).contains("by the times"), "{}", trial.printed(&stated));
}
