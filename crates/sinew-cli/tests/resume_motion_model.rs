//! Runs with a learned motion model are resumed to the same bytes, and with another model not at all.

mod common;

use common::synthetic::Whole;
use sinew::results::problem::Problem;
use sinew::track::checkpoint;
use sinew_motion::follow::NamedBody;
use sinew_motion::points::points_of_states;
use sinew_simulate::recording::write_trc;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tools::learn::{LearnRequest, LearnWatch, learn};
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

const RATE_HZ: f64 = 30.0;

/// Learns from a walk and writes the model.
fn model(folder: &Path, seed: u64) {
    let walker = Walker::new(Gait { still_s: 0.5, duration_s: 3.0, ..Gait::default() });
    let motion = points_of_states(&walker.body, &walker_states(&walker, RATE_HZ));
    let mut bytes = vec![];
    write_trc(&mut bytes, "walk.trc", &motion, RATE_HZ).unwrap();
    let path = folder.join("walk.trc");
    fs::write(&path, bytes).unwrap();
    let request = LearnRequest {
        motion: vec![path],
        held_out: vec![],
        skeleton: None,
        amc_hz: None,
        body: NamedBody::H32,
        fps: RATE_HZ,
        clusters: 6,
        length: 3,
        seed,
    };
    let mut watch = LearnWatch { progress: &mut |_, _, _| {}, stop: &AtomicBool::new(false) };
    learn(&request, &folder.join("model.json"), true, &mut watch).unwrap();
}

/// Before, while and after there are enough estimates for action primitives; with `hmc` the draws of the last frame are part of the state.
#[test]
fn a_run_with_a_model_stopped_after_a_frame_gives_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path(), 1);
    let path = folder.path().join("model.json").display().to_string();
    for method in ["hmc", "bootstrap"] {
        let with = Whole::lasting(12, &[("method", method), ("motion_model", &path)]);
        let without = Whole::lasting(12, &[("method", method)]);
        assert!(with.files["joints.csv"] != without.files["joints.csv"], "{method}: the model changes nothing");
        for stop in [0, 1, 2, 3, 4, 7, 11] {
            with.check_stopped_at(stop);
        }
    }
}

#[test]
fn a_run_with_another_model_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    model(folder.path(), 1);
    let path = folder.path().join("model.json").display().to_string();
    let whole = Whole::lasting(8, &[("method", "bootstrap"), ("motion_model", &path)]);
    let out = whole.folder.path().join("out");
    whole.run(&out, 1, Some(4), None).unwrap();
    model(folder.path(), 2);
    match whole.run(&out, 1, None, Some(checkpoint::read(&out).unwrap())) {
        Err(sinew::Error::Checkpoint { problem, .. }) => {
            let words = problem.to_string();
            assert!(!matches!(*problem, Problem::Settings(_)) && words.contains("motion_model"), "{words}");
        }
        other => panic!("{other:?}"),
    }
}
