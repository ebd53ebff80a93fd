//! Runs with a learned motion model are resumed to the same bytes, and with another model not at all.

use crate::common::synthetic::{Whole, results};
use crate::common::walks::one_walk;
use sinew::track::checkpoint;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::primitives::{LearnRequest, LearnWatch, learn};
use sinew_results::claim;
use sinew_results::problem::Problem;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Learns from a walk and writes the model.
fn model(folder: &Path, body: NamedBody, seed: u64) {
    let files = one_walk(folder, 0.5, 3.0, body);
    let request = LearnRequest { files, clusters: 6, length: 3, seed };
    let stop = &AtomicBool::new(false);
    let mut watch = LearnWatch { progress: &mut |_, _, _| {}, iteration: &mut |_| {}, stop };
    learn(&request, &folder.join("model.json"), true, &mut watch).unwrap();
}

/// Before, while and after there are enough estimates for action primitives; with `hmc` the draws of the last frame are part of the state.
#[test]
fn a_run_with_a_model_stopped_after_a_frame_gives_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path(), NamedBody::H32, 1);
    let path = folder.path().join("model.json").display().to_string();
    for method in ["hmc", "bootstrap"] {
        let with = Whole::lasting(12, &[("method", method), ("motion_model", &path)]);
        let without = Whole::lasting(12, &[("method", method)]);
        assert!(!with.files.contains_key("actions.csv"), "{method} has no action primitives part by part");
        assert!(with.files["joints.csv"] != without.files["joints.csv"], "{method}: the model changes nothing");
        for stop in [0, 1, 2, 3, 4, 7, 11] {
            with.check_stopped_at(stop);
        }
    }
}

/// `actions.csv` is written and resumed; the shares of each part add to 1 in each frame, and clusters are there as soon as there are three estimates.
#[test]
fn actions_are_resumed_and_their_shares_add_to_one() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path(), NamedBody::Hppf24, 1);
    let path = folder.path().join("model.json").display().to_string();
    let settings = [("method", "hppf"), ("body", "hppf24"), ("particles", "16"), ("raster", "64")];
    let without = Whole::from_silhouettes(2, &settings);
    assert!(!without.files.contains_key("actions.csv"), "no model, no actions");
    let whole = Whole::from_silhouettes(8, &[&settings[..], &[("motion_model", &path)]].concat());
    let text = String::from_utf8(whole.files["actions.csv"].clone()).unwrap();
    assert_eq!(text.lines().next(), Some("frame,time_s,person,part,cluster,model,share"));
    let mut sums: BTreeMap<(u64, String), f64> = BTreeMap::new();
    for row in text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>()) {
        let frame: u64 = row[0].parse().unwrap();
        assert_eq!(row[4].is_empty(), frame < 3, "{row:?}");
        assert!(frame >= 3 || row[5] == "walk", "{row:?}");
        *sums.entry((frame, row[3].to_owned())).or_default() += row[6].parse::<f64>().unwrap();
    }
    assert_eq!(sums.len(), 8 * 10);
    assert!(sums.values().all(|sum| (sum - 1.0).abs() < 1e-9), "{sums:?}");
    for model in ["next", "step", "walk"] {
        assert!(text.contains(&format!(",{model},")), "{model}");
    }
    for stop in [0, 1, 2, 3, 5, 7] {
        whole.check_stopped_at(stop);
    }
}

/// What an earlier run by action primitives left does not stay beside the results of another method.
#[test]
fn actions_of_an_earlier_run_are_removed() {
    let whole = Whole::lasting(2, &[("method", "bootstrap")]);
    let out = whole.folder.path().join("out");
    fs::create_dir(&out).unwrap();
    for name in ["actions.csv", "actions.csv.partial"] {
        fs::write(out.join(name), "of another run").unwrap();
    }
    fs::write(out.join("sinew.files"), r#"{"sinew_wrote": ["actions.csv", "actions.csv.partial"]}"#).unwrap();
    whole.run_in(claim(&out, &[], true).unwrap(), 1, None, None).unwrap();
    assert!(results(&out) == whole.files, "something else is there");
}

#[test]
fn a_run_with_another_model_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path(), NamedBody::H32, 1);
    let path = folder.path().join("model.json").display().to_string();
    let whole = Whole::lasting(8, &[("method", "bootstrap"), ("motion_model", &path)]);
    let out = whole.folder.path().join("out");
    whole.run(&out, 1, Some(4), None).unwrap();
    model(folder.path(), NamedBody::H32, 2);
    match whole.run(&out, 1, None, Some(checkpoint::read(&out).unwrap())) {
        Err(sinew::Error::Results(sinew_results::Error::Checkpoint { problem, .. })) => {
            let words = problem.to_string();
            assert!(!matches!(*problem, Problem::Settings(_)) && words.contains("motion_model"), "{words}");
        }
        other => panic!("{other:?}"),
    }
}
