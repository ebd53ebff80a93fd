//! What `sinew inspect` says of the files that `sinew` itself writes and reads, and the settings that it takes.

use crate::common::{TRACK, Trial, trial};
use std::fs;

fn shown(trial: &Trial, arguments: &[&str]) -> String {
    let output = trial.run(&[&["inspect"], arguments].concat());
    format!("{}{}", String::from_utf8_lossy(&output.stdout), trial.printed(&output))
}

fn set_up() -> String {
    let sizes = "spine = 0.48\nshoulder_height = 0.42\nshoulder_half_width = 0.18\nhip_half_width = 0.09\npelvis_drop = 0.1\nupper_arm = 0.3\nforearm = 0.26\nthigh = 0.43\nshin = 0.42\nhead_top = [0.0, 0.0, 0.2]\nnose = [0.0, 0.1, 0.1]\neye = [0.0, 0.1, 0.1]\near = [0.1, 0.0, 0.1]\nheel = [0.0, -0.1, -0.1]\nbig_toe = [0.0, 0.2, -0.1]\nsmall_toe = [0.1, 0.2, -0.1]\n";
    let motion: Vec<String> = (0..32).map(|dof| format!("{}.0", 1 + dof)).collect();
    format!(
        "schema = 2\nbody = \"H32\"\nlayout = \"BODY_25B\"\nperson = 0\nup_axis = \"+z\"\nmodel_error_m = 0.0123\nstart_frame = 5\nstart_pose = [{}]\nstep_size = 0.25\nleapfrog_steps = 7\nmotion_sd = [{}]\n[proportions]\n{sizes}[[camera]]\nname = \"C1\"\noffset_px = [1.5, -2.0]\nsigma_px = 4.0\nusual_confidence = 0.8\n[[camera]]\nname = \"C2\"\noffset_px = [0.0, 0.0]\nsigma_px = 0.0\nusual_confidence = 0.8\nexchanged = 0.7\n",
        vec!["0.0"; 32].join(", "),
        motion.join(", ")
    )
}

#[test]
fn toml_files_are_distinguished() {
    let trial = trial(0.1);
    let files = [
        ("setup.toml", set_up()),
        ("short.toml", set_up().replace("schema = 2\n", "schema = 2\nspeed = 3\n")),
        ("sinew.toml", "root = true\nseed = 4\ncameras = [\"C1\", \"C2\"]\nfps = 60\n".into()),
        ("wrong.toml", "seed = 4\nfsp = 60\n".into()),
        (
            "arm.toml",
            "[[link]]\nname = \"trunk\"\n[[link]]\nname = \"arm\"\nparent = \"trunk\"\njoints = [\"rz\", \"ry\"]\n[[point]]\nname = \"hand\"\nlink = \"arm\"\noffset = [0.5, 0.0, 0.0]\n".into(),
        ),
        ("mapping.toml", "points = [\"Nose\", \"\", \"LHip\", \"RHip\", \"LShoulder\", \"Tail\"]\n".into()),
        ("broken.toml", "seed = = 1\n".into()),
    ];
    for (name, text) in files {
        fs::write(trial.path(name), text).unwrap();
        insta::assert_snapshot!(name, shown(&trial, &[name]));
    }
}

#[test]
fn draws_are_listed() {
    let trial = trial(0.2);
    assert_eq!(trial.track(&["--frames", "1..5"]).status.code(), Some(0));
    let printed = shown(&trial, &["out/posterior.zarr"]);
    insta::assert_snapshot!("posterior.zarr", printed);
    let store = trial.path("out/posterior.zarr");
    assert_eq!(
        sinew_report::inspect::subjects(&[store]).unwrap(),
        [sinew_report::inspect::Subject::Draws(trial.path("out/posterior.zarr"))]
    );
    fs::remove_file(trial.path("out/posterior.zarr/zarr.json")).unwrap();
    insta::assert_snapshot!("no_zarr", shown(&trial, &["out/posterior.zarr"]));
}

#[test]
fn a_run_that_did_not_end_well_says_so() {
    let trial = trial(0.2);
    let too_few = ["--updates=2", "--burn-in=1", "--chains=8", "-oout"];
    assert_eq!(trial.run(&[&TRACK[..], &too_few].concat()).status.code(), Some(4));
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(trial.path("out/summary.json")).unwrap()).unwrap();
    let failed = summary["failed_diagnostics"].as_array().unwrap();
    let printed = shown(&trial, &["out"]);
    for failed in failed {
        let line = format!("  odd: diagnostic failed: {}\n", failed.as_str().unwrap());
        assert!(printed.contains(&line), "{line} in {printed}");
    }
    assert!(!failed.is_empty() && !printed.contains("interrupted"), "{printed}");

    trial.edit(&trial.path("out/summary.json"), |text| text.replace("\"complete\": true", "\"complete\": false"));
    assert!(shown(&trial, &["out"]).contains("  odd: the run was interrupted: not all frames are there\n"));

    fs::copy(trial.path("out/joints.csv"), trial.path("out/joints.csv.partial")).unwrap();
    assert!(shown(&trial, &["out"]).contains("  odd: a later run was stopped before its end"));
}

#[test]
fn a_run_that_did_not_end_at_all_says_so() {
    let trial = trial(0.1);
    fs::create_dir(trial.path("out")).unwrap();
    let claim = sinew_results::claim(&trial.path("out"), &[], false).unwrap();
    insta::assert_snapshot!("begun", shown(&trial, &["out"]));
    fs::write(trial.path("out/joints.csv.partial"), "").unwrap();
    fs::write(trial.path("out/frames.csv.partial"), "frame,time_s\n0,0.0\n1,0.1\n2,").unwrap();
    insta::assert_snapshot!("running", shown(&trial, &["out"]));
    drop(claim);
    insta::assert_snapshot!("killed", shown(&trial, &["out"]));
    fs::write(trial.path("out/sinew.lock"), "4000000\n").unwrap();
    fs::remove_file(trial.path("out/joints.csv.partial")).unwrap();
    fs::remove_file(trial.path("out/frames.csv.partial")).unwrap();
    insta::assert_snapshot!("killed_early", shown(&trial, &["out"]));
}

#[test]
fn keypoints_are_read_with_the_settings_of_a_run() {
    let trial = trial(0.4);
    let printed =
        shown(&trial, &["Calib.toml", "pose", "--layout", "BODY_25B", "--cameras", "C1,C3", "--frames", "2..9"]);
    assert!(printed.contains("pose: keypoints of 2 cameras"), "{printed}");
    assert!(printed.contains("C3_json  7 files, frames 2..9"), "{printed}");
    assert!(printed.contains("fit of calibration and keypoints, frames 2..9"), "{printed}");
    insta::assert_snapshot!("unknown_camera", shown(&trial, &["pose", "--cameras", "C1,C7"]));
    insta::assert_snapshot!("no_such_frames", shown(&trial, &["pose", "--frames", "50..60"]));

    // The settings of the trial count too.
    fs::write(trial.path("sinew.toml"), "root = true\ncameras = [\"C2\"]\n").unwrap();
    assert!(shown(&trial, &["pose"]).contains("pose: keypoints of 1 cameras"));

    fs::remove_file(trial.path("sinew.toml")).unwrap();
    for (camera, frame) in (1..=4).flat_map(|camera| (0..12).map(move |frame| (camera, frame))) {
        trial.edit(&trial.keypoints(camera, frame), |text| {
            let mut json: serde_json::Value = serde_json::from_str(&text).unwrap();
            for person in json["people"].as_array_mut().unwrap() {
                for confidence in person["pose_keypoints_2d"].as_array_mut().unwrap().iter_mut().skip(2).step_by(3) {
                    *confidence = (100.0 * confidence.as_f64().unwrap()).into();
                }
            }
            json.to_string()
        });
    }
    assert!(shown(&trial, &["pose"]).contains("exit 3"));
    assert!(shown(&trial, &["Calib.toml", "pose", "--confidence-scale", "100"]).contains("exit 0"));
}
