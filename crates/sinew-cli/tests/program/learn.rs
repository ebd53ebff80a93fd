//! `sinew learn primitives`, what comes of its model in `inspect` and `track`, and what the user reads about bad input.

use crate::common::walks::{learned, walks};
use crate::common::{Trial, files, trial};
use std::fs;

const LEARN: [&str; 10] =
    ["learn", "primitives", "--motion", "a.trc", "--body", "h32", "--clusters", "6", "--no-progress", "-omodel.json"];

fn learn(trial: &Trial, more: &[&str]) -> String {
    learned(trial, &LEARN, more)
}

#[test]
fn help_names_every_flag() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    for (name, arguments) in [("help_learn", vec!["learn", "-h"]), ("help", vec!["learn", "primitives", "-h"])] {
        let text = String::from_utf8(trial.run(&arguments).stdout).unwrap();
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        insta::assert_snapshot!(name, text);
    }
}

#[test]
fn a_model_is_learned_reported_inspected_and_drawn() {
    let trial = walks("3");
    let printed = learn(&trial, &["--held-out", "b.trc"]);
    for words in
        ["motion    1 file", "held out  1 file", "model     h32, 20 frames per second", "switching", "velocity"]
    {
        assert!(printed.contains(words), "{words}\n{printed}");
    }
    let model = fs::read(trial.path("model.json")).unwrap();
    let again = learn(&trial, &["--force", "--threads", "1", "--json"]);
    assert_eq!(fs::read(trial.path("model.json")).unwrap(), model, "another number of threads");
    let json: serde_json::Value = serde_json::from_str(&again).unwrap();
    assert_eq!(json["feature_vectors"][0]["name"], "body");
    assert!(json["motion"][0]["mean_error_mm"].as_f64().unwrap() < 30.0);
    learn(&trial, &["--force", "--seed", "2"]);
    assert_ne!(fs::read(trial.path("model.json")).unwrap(), model, "another seed");

    let inspected = trial.run(&["inspect", "model.json", "-o", "model.svg"]);
    let text = String::from_utf8_lossy(&inspected.stdout).into_owned();
    assert!(text.starts_with("model.json: motion model of action primitives\n"), "{text}");
    assert!(text.contains("20 frames per second") && text.contains("22 angles"), "{text}");
    assert!(fs::read_to_string(trial.path("model.svg")).unwrap().contains("cluster 0"));
    assert_eq!(files(trial.folder.path()).len(), 4, "no file is left over");
}

#[test]
fn learning_shows_its_iterations_unless_it_is_quiet() {
    let trial = walks("3");
    let stderr = |more: &[&str]| {
        let output = trial.run(&[&LEARN[..6], &["-omodel.json", "--force"], more].concat());
        assert!(output.status.success(), "{}", trial.printed(&output));
        String::from_utf8(output.stderr).unwrap()
    };
    let shown = stderr(&["--clusters", "20"]);
    assert!(shown.contains("learning: body, iteration 20, log likelihood changed by "), "{shown}");
    assert!(shown.contains("learning: 100 % (1 of 1 vectors)"), "{shown}");
    assert_eq!(stderr(&["--clusters", "20", "-q"]), "");
    assert_eq!(stderr(&["--clusters", "20", "--no-progress"]), "");
}

#[test]
fn unusable_motion_is_refused() {
    let trial = walks("3");
    let printed = |arguments: &[&str]| trial.printed(&trial.run(arguments));
    let with = |motion: &str, more: &[&str]| {
        let arguments = ["learn", "primitives", "--motion", motion, "--body", "h32", "--no-progress"];
        printed(&[&arguments[..], more].concat())
    };
    insta::assert_snapshot!("no_output", with("a.trc", &[]));
    insta::assert_snapshot!("no_file", with("nothing.trc", &["-omodel.json"]));
    insta::assert_snapshot!("no_acclaim_file", with("nothing.amc", &["-omodel.json"]));
    insta::assert_snapshot!("output_is_input", with("a.trc", &["-oa.trc", "--force"]));
    insta::assert_snapshot!("exists", with("a.trc", &["-ob.trc"]));
    insta::assert_snapshot!("unknown_body", printed(&["learn", "primitives", "--motion", "a.trc", "--body", "horse"]));
    insta::assert_snapshot!("no_rate", with("a.trc", &["-om", "--fps", "0"]));
    insta::assert_snapshot!("too_long", with("a.trc", &["-om", "--length", "100"]));
    fs::write(trial.path("walk_01.amc"), ":FULLY-SPECIFIED\n:DEGREES\n1\n").unwrap();
    insta::assert_snapshot!("no_skeleton", with("walk_01.amc", &["-om"]));
    let text = fs::read_to_string(trial.path("b.trc")).unwrap();
    fs::write(trial.path("b.trc"), text.replace("RKnee", "Somebody")).unwrap();
    insta::assert_snapshot!("no_knee", with("b.trc", &["-om"]));
    assert!(!trial.path("m").exists() && !trial.path("model.json").exists());
}

/// What `inspect` and `track` say of files that are no model, or one of something else.
#[test]
fn models_that_do_not_fit_are_refused() {
    let walks = walks("3");
    learn(&walks, &[]);
    let trial = trial(0.5);
    let model = fs::read_to_string(walks.path("model.json")).unwrap();
    fs::write(trial.path("model.json"), &model).unwrap();
    let track = |more: &[&str]| trial.track_printed(&[&["--motion-model", "model.json"], more].concat());
    insta::assert_snapshot!("other_rate", track(&[]));
    insta::assert_snapshot!("other_body", track(&["--body", "cf28"]));
    insta::assert_snapshot!("partitioned", track(&["--method", "partitioned"]));
    insta::assert_snapshot!("coarse_to_fine", track(&["--method", "coarse-to-fine"]));
    insta::assert_snapshot!("smooth", track(&["--smooth"]));
    fs::write(trial.path("model.json"), model.replacen("\"frame_rate\":20.0", "\"frame_rate\":-20.0", 1)).unwrap();
    insta::assert_snapshot!("broken_value", track(&[]));
    insta::assert_snapshot!("inspect_broken", trial.printed(&trial.run(&["inspect", "model.json"])));
    fs::write(trial.path("model.json"), model.replacen("\"version\":1", "\"version\":7", 1)).unwrap();
    insta::assert_snapshot!("other_version", track(&[]));
    fs::write(trial.path("model.json"), "{}").unwrap();
    insta::assert_snapshot!("no_model", track(&[]));
    let drawn = trial.run(&["inspect", "Calib.toml", "-o", "picture.svg"]);
    insta::assert_snapshot!("nothing_to_draw", trial.printed(&drawn));
}

/// A learned model tracks, its hash is in the summary, and another model at the same path is another run.
#[test]
fn a_run_with_a_model_knows_which_one() {
    let walks = walks("3");
    learn(&walks, &["--fps", "30"]);
    let trial = trial(0.5);
    fs::copy(walks.path("model.json"), trial.path("model.json")).unwrap();
    let track =
        |more: &[&str]| trial.track(&[&["--motion-model", "model.json", "--method", "bootstrap"], more].concat());
    let first = track(&["--particles", "200", "--min-ess", "0"]);
    assert!(first.status.success(), "{}", trial.printed(&first));
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(trial.path("out/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["input_hashes"]["motion_model"].as_str().map(str::len), Some(16));
    learn(&walks, &["--fps", "30", "--force", "--seed", "2"]);
    fs::copy(walks.path("model.json"), trial.path("model.json")).unwrap();
    let resumed = track(&["--particles", "200", "--min-ess", "0", "--resume"]);
    insta::assert_snapshot!("another_model", trial.printed(&resumed));
}
