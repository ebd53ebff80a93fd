//! What the user reads about bad keypoint folders and calibrations that do not fit them.

use crate::common::{QUICK, Trial, trial};
use std::fs;

/// Third keypoint list entry by entry: x, y, confidence of the first person in a file.
fn set_first_point(trial: &Trial, camera: usize, frame: usize, point: &str) {
    trial.edit(&trial.keypoints(camera, frame), |text| {
        let start = text.find("_2d\": [").unwrap() + "_2d\": [".len();
        let end = text[start..].match_indices(", ").nth(2).unwrap().0 + start;
        format!("{}{point}{}", &text[..start], &text[end..])
    });
}

fn check_error(name: &str, harm: impl FnOnce(&Trial), more: &[&str]) {
    let trial = trial(0.2);
    harm(&trial);
    insta::assert_snapshot!(name, trial.track_printed(more));
    assert!(!trial.path("out/summary.json").exists());
}

fn check_warning(name: &str, harm: impl FnOnce(&Trial), more: &[&str]) {
    let trial = trial(0.4);
    harm(&trial);
    let output = trial.track(more);
    insta::assert_snapshot!(name, trial.printed(&output));
    assert!(trial.path("out/summary.json").exists());
}

#[test]
fn nobody_in_some_frames() {
    check_warning(
        "nobody",
        |trial| {
            fs::write(trial.keypoints(2, 5), r#"{"people": []}"#).unwrap();
            fs::write(trial.keypoints(2, 7), r#"{"people": [{}]}"#).unwrap();
        },
        &[],
    );
}

#[test]
fn nobody_anywhere_for_a_while() {
    check_warning(
        "nobody_anywhere",
        |trial| {
            for camera in 1..=4 {
                for frame in [4, 5, 6] {
                    fs::write(trial.keypoints(camera, frame), r#"{"people": []}"#).unwrap();
                }
            }
        },
        &[],
    );
}

#[test]
fn points_without_coordinates() {
    check_warning("null_coordinates", |trial| set_first_point(trial, 1, 3, "null, 5.0, 0.8"), &[]);
}

#[test]
fn points_at_the_origin() {
    check_warning("origin", |trial| set_first_point(trial, 1, 3, "0, 0, 0.8"), &[]);
}

#[test]
fn missing_files() {
    check_warning("holes", |trial| fs::remove_file(trial.keypoints(2, 4)).unwrap(), &[]);
}

#[test]
fn one_camera() {
    check_warning("one_camera", |_| {}, &["--cameras", "C1"]);
}

#[test]
fn a_camera_without_folder() {
    check_warning("camera_without_folder", |trial| fs::remove_dir_all(trial.path("pose/C3_json")).unwrap(), &[]);
}

#[test]
fn confidence_in_percent() {
    check_error("confidence", |trial| set_first_point(trial, 1, 0, "10, 10, 87.0"), &[]);
}

#[test]
fn too_few_numbers() {
    let short = r#"{"people": [{"pose_keypoints_2d": [1, 2, 0.5]}]}"#;
    check_error("too_few_numbers", |trial| fs::write(trial.keypoints(1, 0), short).unwrap(), &[]);
}

#[test]
fn an_unknown_layout() {
    let trial = trial(0.1);
    let output = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", "pose", "--layout", "halpe27"]);
    insta::assert_snapshot!("unknown_layout", trial.printed(&output));
}

#[test]
fn a_layout_that_the_keypoints_contradict() {
    let trial = trial(0.4);
    let inspect = |layout: &str| {
        String::from_utf8(trial.run(&["inspect", "pose", "--layout", layout, "--frames", "0..2"]).stdout).unwrap()
    };
    assert!(!inspect("BODY_25B").contains("look like"));
    let printed = inspect("BODY_25");
    assert!(
        printed.contains("odd: keypoints look like BODY_25B, by the place of the hips; BODY_25 was requested"),
        "{printed}"
    );
    let named = ["track", "--calibration", "Calib.toml", "--keypoints", "pose", "--layout", "BODY_25", "--fps=30"];
    let output = trial.run(&[&named[..], &QUICK, &["-oout", "--no-progress"]].concat());
    let printed = trial.printed(&output);
    let warning = printed.lines().find(|line| line.contains("look like"));
    insta::assert_snapshot!("wrong_layout", warning.unwrap_or(&printed));
    // The same people in the order of the other layout.
    let [ours, other] = ["BODY_25B", "BODY_25"].map(|name| sinew::formats::layout::find(name).unwrap());
    for (camera, frame) in (1..=4).flat_map(|camera| (0..12).map(move |frame| (camera, frame))) {
        trial.edit(&trial.keypoints(camera, frame), |text| {
            let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
            let points: Vec<f64> = serde_json::from_value(json["people"][0]["pose_keypoints_2d"].clone()).unwrap();
            let at = |name: &str| ours.index(name).map(|index| [0, 1, 2].map(|k| points[3 * index + k]));
            let mean = |a: &str, b: &str| Some([0, 1, 2].map(|k| (at(a).unwrap()[k] + at(b).unwrap()[k]) / 2.0));
            let point = |name: &Option<String>| match name.as_deref().unwrap() {
                "MidHip" => mean("LHip", "RHip"),
                "MidShoulder" => mean("LShoulder", "RShoulder"),
                name => at(name),
            };
            let moved: Vec<f64> = other.points.iter().flat_map(|name| point(name).unwrap_or_default()).collect();
            json["people"][0]["pose_keypoints_2d"] = moved.into();
            json.to_string()
        });
    }
    assert!(!inspect("BODY_25").contains("look like"));
    assert!(inspect("BODY_25B").contains("look like BODY_25, by the place of the hips; BODY_25B was requested"));
    insta::assert_snapshot!("sizes_of_nobody", trial.track_printed(&["--force"]));
    let any = trial.track_printed(&["--force", "--any-size"]);
    assert!(!any.contains("error:") && any.contains("look like BODY_25"), "{any}");
}

#[test]
fn a_layout_without_hips() {
    let trial = trial(0.1);
    fs::write(trial.path("mine.toml"), "points = [\"Nose\", \"RHip\"]\n").unwrap();
    let output = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", "pose", "--layout", "mine.toml"]);
    insta::assert_snapshot!("layout_without_hips", trial.printed(&output));
}

#[test]
fn a_camera_folder_without_files() {
    let empty = |trial: &Trial| {
        fs::remove_dir_all(trial.path("pose/C2_json")).unwrap();
        fs::create_dir(trial.path("pose/C2_json")).unwrap();
    };
    check_error("empty_camera_folder", empty, &[]);
}

#[test]
fn frames_beyond_the_recording() {
    check_warning("frames_clipped", |_| {}, &["--frames", "2..40"]);
}

#[test]
fn cameras_that_end_apart() {
    let shorten = |trial: &Trial| fs::remove_file(trial.keypoints(3, 5)).unwrap();
    check_error("ends_apart", shorten, &[]);
    check_warning("ends_apart_trimmed", |trial| fs::remove_file(trial.keypoints(3, 11)).unwrap(), &["--trim"]);
}

#[test]
fn frames_that_do_not_exist() {
    check_error("no_such_frames", |_| {}, &["--frames", "100..200"]);
}

#[test]
fn two_files_of_one_frame() {
    let double =
        |trial: &Trial| fs::copy(trial.keypoints(1, 1), trial.path("pose/C1_json/C1.1.json")).map(drop).unwrap();
    check_error("two_files", double, &[]);
}

#[test]
fn a_file_without_number() {
    check_error("no_number", |trial| fs::write(trial.path("pose/C1_json/notes.json"), "{}").unwrap(), &[]);
}

#[test]
fn frame_numbers_that_are_dates() {
    let rename = |trial: &Trial| {
        fs::rename(trial.keypoints(1, 0), trial.path("pose/C1_json/C1.20240228120000.json")).unwrap();
    };
    check_error("dates", rename, &["--trim", "--cameras", "C1"]);
}

#[test]
fn a_folder_that_is_not_calibrated() {
    let rename = |trial: &Trial| fs::rename(trial.path("pose/C3_json"), trial.path("pose/cam9_json")).unwrap();
    check_error("not_calibrated", rename, &[]);
}

#[test]
fn two_folders_of_one_camera() {
    let copy = |trial: &Trial| {
        fs::create_dir(trial.path("pose/c_01_json")).unwrap();
    };
    check_error("two_folders", copy, &[]);
}

#[test]
fn an_unknown_camera() {
    check_error("unknown_camera", |_| {}, &["--cameras", "C1,C7"]);
}

#[test]
fn no_keypoints_at_all() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("empty")).unwrap();
    let track = |keypoints: &str| {
        trial.printed(&trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", keypoints]))
    };
    insta::assert_snapshot!("empty_folder", track("empty"));
    insta::assert_snapshot!("camera_folder_itself", track("pose/C1_json"));
    insta::assert_snapshot!("no_such_folder", track("pse"));
}

#[test]
fn damaged_files() {
    check_error("truncated", |trial| trial.edit(&trial.keypoints(2, 2), |text| text[..200].to_owned()), &[]);
    check_error("not_utf8", |trial| fs::write(trial.keypoints(2, 2), b"{\"people\": \"\n\xE9\"}").unwrap(), &[]);
    check_error("deep", |trial| fs::write(trial.keypoints(2, 2), "[".repeat(100_000)).unwrap(), &[]);
    check_error("out_of_range", |trial| set_first_point(trial, 2, 2, "1e999, 5, 0.8"), &[]);
    check_error(
        "calibration_truncated",
        |trial| trial.edit(&trial.path("Calib.toml"), |text| text[..60].to_owned()),
        &[],
    );
}

#[test]
fn marks_and_line_ends_do_not_matter() {
    let trial = trial(0.2);
    let plain = trial.track(&[]);
    let markers = fs::read(trial.path("out/markers.trc")).unwrap();
    for frame in 0..6 {
        trial.edit(&trial.keypoints(1, frame), |text| format!("\u{feff}{}", text.replace('\n', "\r\n")));
    }
    let marked = trial.track(&["--force"]);
    assert_eq!(plain.status.code(), marked.status.code());
    assert_eq!(fs::read(trial.path("out/markers.trc")).unwrap(), markers);
}

#[test]
fn swapped_sides_and_a_jump() {
    let trial = trial(1.4);
    let layout = sinew::formats::layout::find("BODY_25B").unwrap();
    for frame in 20..30 {
        trial.edit(&trial.keypoints(2, frame), |text| {
            let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
            let points = json["people"][0]["pose_keypoints_2d"].as_array_mut().unwrap();
            for (l, r) in layout.left_right_pairs() {
                (0..3).for_each(|k| points.swap(3 * l + k, 3 * r + k));
            }
            json.to_string()
        });
    }
    trial.edit(&trial.keypoints(3, 35), |text| {
        let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let points = json["people"][0]["pose_keypoints_2d"].as_array_mut().unwrap();
        for u in points.iter_mut().step_by(3) {
            *u = serde_json::json!(u.as_f64().unwrap() + 400.0);
        }
        json.to_string()
    });
    insta::assert_snapshot!("swap_and_jump", without_pixels(&trial.track_printed(&[])));
}

/// Numbers of pixels, which depend on chance, as `#`.
fn without_pixels(text: &str) -> String {
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let counts =
            |i: usize| words.get(i + 1) == Some(&"px") || words.get(i + 3) == Some(&"px") && words[i + 1] == "to";
        let shown: Vec<&str> = (0..words.len()).map(|i| if counts(i) { "#" } else { words[i] }).collect();
        shown.join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Changes each camera of the calibration.
fn edit_calibration(trial: &Trial, change: impl Fn(&str, &mut toml::Table)) {
    trial.edit(&trial.path("Calib.toml"), |text| {
        let mut calibration: toml::Table = text.parse().unwrap();
        for (name, camera) in &mut calibration {
            camera
                .as_table_mut()
                .into_iter()
                .filter(|camera| camera.contains_key("matrix"))
                .for_each(|c| change(name, c));
        }
        calibration.to_string()
    });
}

fn multiply(value: &mut toml::Value, factor: f64) {
    match value {
        toml::Value::Array(items) => items.iter_mut().for_each(|item| multiply(item, factor)),
        other => *other = (factor * other.as_float().unwrap()).into(),
    }
}

#[test]
fn images_resized_after_the_calibration() {
    let larger = |trial: &Trial| {
        edit_calibration(trial, |_, camera| {
            multiply(&mut camera["size"], 1.5);
            multiply(&mut camera["matrix"], 1.5);
            camera["matrix"][2][2] = 1.0.into();
        });
    };
    check_error("resized", larger, &[]);
    check_warning("resized_and_declared", larger, &["--image-scale", "0.6667"]);
}

/// The calibrations of two cameras are exchanged.
#[test]
fn a_calibration_of_another_camera() {
    let trial = trial(1.0);
    trial.edit(&trial.path("Calib.toml"), |text| {
        text.replace("\"C1\"", "\"X\"").replace("\"C2\"", "\"C1\"").replace("\"X\"", "\"C2\"")
    });
    let printed = trial.track_printed(&[]);
    insta::assert_snapshot!("exchanged", without_pixels(&printed));
    let inspected = trial.run(&["inspect", "Calib.toml", "pose"]);
    let inspected = String::from_utf8(inspected.stdout).unwrap();
    assert!(
        inspected.contains("odd: the keypoints of all cameras fit when the calibrations of C1 and C2 are exchanged")
    );
}

/// The calibration of a camera is that of another place, which no exchange mends.
#[test]
fn a_calibration_of_no_camera_of_these() {
    let trial = trial(1.0);
    edit_calibration(&trial, |name, camera| {
        if name.ends_with('2') {
            camera["rotation"] = vec![1.9, 0.3, -0.4].into();
        }
    });
    let printed = trial.track_printed(&[]);
    assert!(printed.contains("is this the calibration of this camera?") && !printed.contains("exchanged"), "{printed}");
}

/// Tracks the second in which the walker walks.
fn tracked_at(trial: &Trial, fps: &str, more: &[&str]) -> String {
    let given = ["track", "--calibration", "Calib.toml", "--keypoints", "pose", "--layout", "BODY_25B"];
    let output = ["--no-progress", "--force", "-oout", "--frames", "30..60", "--fps", fps];
    trial.printed(&trial.run(&[&given[..], &output, &QUICK, more].concat()))
}

#[test]
fn frame_rates_that_nobody_is_fast_enough_for() {
    let trial = trial(2.0);
    let is_warned = |printed: &str| printed.contains("is `--fps` right?");
    assert!(!is_warned(&tracked_at(&trial, "60", &[])));
    let printed = tracked_at(&trial, "600", &[]);
    assert!(printed.starts_with("exit 0") && is_warned(&printed), "{printed}");
    let printed = tracked_at(&trial, "6000", &[]);
    assert!(
        printed.starts_with("exit 3") && is_warned(&printed) && printed.contains("help: give the frame rate"),
        "{printed}"
    );
    let printed = tracked_at(&trial, "6000", &["--any-size"]);
    assert!(is_warned(&printed) && !printed.contains("error:"), "{printed}");
}

#[test]
fn one_camera_that_shows_someone_whom_no_other_sees() {
    let trial = trial(1.0);
    for frame in 0..30 {
        trial.edit(&trial.keypoints(2, frame), |text| {
            let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
            let points = json["people"][0]["pose_keypoints_2d"].as_array_mut().unwrap();
            for u in points.iter_mut().step_by(3) {
                *u = serde_json::json!(1280.0 - u.as_f64().unwrap() * 0.3);
            }
            json.to_string()
        });
    }
    insta::assert_snapshot!("unmatched", without_pixels(&trial.track_printed(&[])));
}

#[test]
fn confidences_far_below_the_declared_scale() {
    check_error("surest", |_| {}, &["--confidence-scale", "1000"]);
}

#[test]
fn a_set_up_does_not_hide_what_no_longer_fits() {
    let trial = trial(0.4);
    assert_eq!(trial.track(&["-ofirst"]).status.code(), Some(0));
    edit_calibration(&trial, |_, camera| {
        multiply(&mut camera["size"], 1.5);
        multiply(&mut camera["matrix"], 1.5);
        camera["matrix"][2][2] = 1.0.into();
    });
    insta::assert_snapshot!("resized_with_set_up", trial.track_printed(&["--setup", "first/setup.toml"]));
    insta::assert_snapshot!("resized_twice", trial.track_printed(&["--image-scale", "2"]));
}

#[test]
fn the_advice_about_the_axis_is_that_of_the_calibration() {
    let advised = |declared: &str| {
        let trial = trial(0.4);
        trial.track_printed(&[declared])
    };
    for declared in ["--up-axis=-z", "--up-axis=+y", "--up=1e300,1e300,0"] {
        assert!(
            advised(declared).contains("leave `up_axis` and `up` out (found: +z, the default)"),
            "{}",
            advised(declared)
        );
    }
}

#[test]
fn millimetres_for_metres() {
    check_error("millimetres", |trial| edit_calibration(trial, |_, c| multiply(&mut c["translation"], 1e3)), &[]);
}

#[test]
fn poses_of_the_cameras_instead_of_the_world() {
    let invert = |trial: &Trial| {
        let text = fs::read_to_string(trial.path("Calib.toml")).unwrap();
        let cameras = sinew::formats::calib_toml::read("Calib.toml", &text).unwrap().cameras;
        edit_calibration(trial, |name, entry| {
            let camera = cameras.iter().find(|camera| camera.name == entry["name"].as_str().unwrap()).expect(name);
            multiply(&mut entry["rotation"], -1.0);
            entry["translation"] = camera.centre().to_vec().into();
        });
    };
    check_error("inverted", invert, &[]);
}

#[test]
fn points_beyond_the_lens() {
    let harm = |trial: &Trial| {
        edit_calibration(trial, |name, camera| {
            if name.ends_with('1') {
                camera["distortions"][0] = (-0.001).into();
            }
        });
        set_first_point(trial, 1, 3, "90000.0, 10.0, 0.8");
    };
    check_warning("beyond_lens", harm, &[]);
}

/// Files 9, 10 and 11 sort as 10, 11, 9 by name.
#[test]
fn frames_go_by_number() {
    let trial = trial(0.4);
    for camera in 1..=4 {
        for frame in 0..12 {
            fs::rename(
                trial.keypoints(camera, frame),
                trial.path(&format!("pose/C{camera}_json/C{camera}.{frame}.json")),
            )
            .unwrap();
        }
    }
    let output = trial.track(&["--frames", "8..12"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let table = fs::read_to_string(trial.path("out/frames.csv")).unwrap();
    let frames: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    assert_eq!(frames, ["8", "9", "10", "11"]);
}

#[cfg(unix)]
#[test]
fn names_need_not_be_utf8() {
    use std::os::unix::ffi::OsStrExt as _;
    let trial = trial(0.2);
    let odd = trial.folder.path().join(std::ffi::OsStr::from_bytes(b"p\xFFose"));
    fs::rename(trial.path("pose"), &odd).unwrap();
    let mut command = trial.command(&["inspect"]);
    assert_eq!(command.arg(&odd).output().unwrap().status.code(), Some(0));
}
