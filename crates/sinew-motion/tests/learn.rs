//! Learning from the files of a synthetic walk.

use sinew_body::points::points_of_states;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::learning::LearningProgress;
use sinew_motion::Error;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::motion_files::{LearnPhase, MotionFiles};
use sinew_motion::learn::primitives::{LearnRequest, LearnWatch, LearnedPrimitives, learn};
use sinew_motion::learn::sequences::{Acclaim, sequences};
use sinew_simulate::recording::write_trc;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// A walk of four seconds at 40 frames a second as a TRC file.
fn walk(folder: &Path, name: &str, stride_s: f64) -> PathBuf {
    let walker = Walker::new(Gait { still_s: 0.0, stride_s, duration_s: 4.0, ..Gait::default() });
    let motion = points_of_states(&walker.body, &walker_states(&walker, 40.0));
    let path = folder.join(name);
    let mut bytes = Vec::new();
    write_trc(&mut bytes, name, &motion, 40.0).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

fn request(folder: &Path, body: NamedBody) -> LearnRequest {
    let files = MotionFiles {
        motion: vec![walk(folder, "a.trc", 1.1), walk(folder, "b.trc", 1.25)],
        held_out: vec![walk(folder, "c.trc", 1.2)],
        skeleton: None,
        amc_hz: None,
        body,
        fps: 20.0,
    };
    LearnRequest { files, clusters: 5, length: 3, seed: 1 }
}

/// Learns, and stops after that many feature vectors.
fn run(request: &LearnRequest, out: &Path, most: u64) -> Result<LearnedPrimitives, Error> {
    let stop = AtomicBool::new(false);
    let mut progress = |phase, done, _| {
        if phase == LearnPhase::Learn && done >= most {
            stop.store(true, Ordering::SeqCst);
        }
    };
    let mut iteration = |_: &LearningProgress<'_>| {};
    learn(request, out, false, &mut LearnWatch { progress: &mut progress, iteration: &mut iteration, stop: &stop })
}

/// Every iteration of every feature vector is shown, in order, and the last one is the model's.
#[test]
fn learning_shows_every_iteration() {
    let folder = tempfile::tempdir().unwrap();
    let (mut seen, mut likelihoods) = (vec![], vec![]);
    let mut iteration = |progress: &LearningProgress<'_>| {
        seen.push((progress.index, progress.iteration, progress.feature.to_owned(), progress.count));
        likelihoods.push(progress.log_likelihood);
    };
    let watch =
        &mut LearnWatch { progress: &mut |_, _, _| {}, iteration: &mut iteration, stop: &AtomicBool::new(false) };
    let out = folder.path().join("model.json");
    let model = learn(&request(folder.path(), NamedBody::Hppf24), &out, false, watch).unwrap().model.unwrap();
    let expected = model.primitives.iter().enumerate().flat_map(|(index, primitives)| {
        let name = primitives.feature.name.clone();
        (0..=primitives.clustering.iterations).map(move |iteration| (index, iteration, name.clone(), 14))
    });
    assert!(seen.iter().cloned().eq(expected), "{seen:?}");
    assert_eq!(likelihoods.last(), Some(&model.primitives[13].clustering.log_likelihood));
}

#[test]
fn a_walk_gives_a_model_that_predicts_another() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("walk.json");
    let learned = run(&request(folder.path(), NamedBody::H32), &out, 99).unwrap();
    let model = learned.model.clone().unwrap();
    assert_eq!(file::read("walk.json", &fs::read_to_string(&out).unwrap()), Ok(model.clone()));
    assert_eq!((model.state.as_str(), model.dim, model.frame_rate), ("h32", 32, 20.0));
    // Two files in two phases of about 80 frames: windows of four within each.
    assert_eq!(learned.summaries[0].windows, learned.training.iter().map(|file| file.frames - 6).sum::<usize>());
    assert!(learned.training.iter().chain(&learned.held_out).all(|file| file.mean_error_m < 0.03), "{learned:?}");
    let errors = learned.summaries[0].held_out.unwrap();
    assert!(errors.step < errors.no_change, "{errors:?}");
}

/// The bytes of an interrupted run and of an unbroken one are the same, and nothing but the model is left.
#[test]
fn an_interrupted_run_continues_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let request = request(folder.path(), NamedBody::Hppf24);
    let [whole, parts] = ["whole.json", "parts.json"].map(|name| folder.path().join(name));
    let model = run(&request, &whole, 99).unwrap().model.unwrap();
    assert_eq!(model.primitives.len(), 14);
    for most in [1, 5] {
        let stopped = run(&request, &parts, most).unwrap();
        assert_eq!((stopped.model, stopped.done), (None, [most as usize, 14]));
        assert!(!parts.exists());
    }
    let resumed = run(&request, &parts, 99).unwrap();
    assert!(resumed.warnings.is_empty() && resumed.done == [14, 14]);
    assert_eq!(fs::read(&whole).unwrap(), fs::read(&parts).unwrap());
    assert!(!folder.path().join("parts.json.unfinished").exists());
}

#[test]
fn unfinished_feature_vectors_of_others_are_not_taken() {
    let folder = tempfile::tempdir().unwrap();
    let request = request(folder.path(), NamedBody::Hppf24);
    let out = folder.path().join("model.json");
    run(&request, &out, 1).unwrap();
    let beside = folder.path().join("model.json.unfinished");
    let text = fs::read_to_string(&beside).unwrap();
    let other = LearnRequest { seed: 2, ..request.clone() };
    let warned = |request: &LearnRequest| run(request, &out, 1).unwrap().warnings.concat();
    assert!(warned(&other).contains("belongs to other motion or settings; all is learned again"));
    fs::write(&beside, text.replacen("\"members\":", "\"members\":1", 1)).unwrap();
    assert!(warned(&request).contains("is damaged; all is learned again"));
    fs::write(&beside, &text[..100]).unwrap();
    assert!(warned(&request).contains("is damaged"));
}

#[test]
fn outputs_and_recordings_that_are_unfit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut request = request(folder.path(), NamedBody::H32);
    let message = |request: &LearnRequest, out: &Path| run(request, out, 99).unwrap_err().to_string();
    assert!(message(&request, &request.files.motion[0]).contains("is also the input"));
    let other = folder.path().join("other.json");
    fs::write(&other, "mine").unwrap();
    assert!(matches!(run(&request, &other, 99), Err(Error::Results(sinew_results::Error::OutputExists { .. }))));
    assert_eq!(fs::read_to_string(&other).unwrap(), "mine");

    let text = fs::read_to_string(&request.files.motion[1]).unwrap();
    let out = folder.path().join("new.json");
    fs::write(&request.files.motion[1], text.replace("RKnee", "Nobody")).unwrap();
    assert!(message(&request, &out).contains("b.trc: no joint is known as RKnee"));
    fs::write(&request.files.motion[1], text.lines().take(7).collect::<Vec<_>>().join("\n")).unwrap();
    assert!(message(&request, &out).contains("b.trc"));
    fs::write(&request.files.motion[1], &text).unwrap();
    request.clusters = 1;
    request.length = 100;
    assert!(
        message(&request, &out).starts_with("no file is long enough for a primitive of 100 frames"),
        "{}",
        message(&request, &out)
    );
}

#[path = "../../../tests/src/data.rs"]
mod shared_data;

/// AMC files state no rate: at the 30 frames a second that this one has, a person walks, at 120 they would race.
#[test]
fn acclaim_files_have_the_rate_that_is_given() {
    let Some(folder) = shared_data::shared("cmu_amc_35") else { return };
    let speed = |hz: Option<f64>| {
        let acclaim = Acclaim { skeleton: None, hz };
        let found = sequences(NamedBody::Hppf24, &[folder.join("walk_01.amc")], acclaim, 20.0, &mut |_| {}).unwrap();
        let (states, dim) = (&found.states[0], NamedBody::Hppf24.tree().dof());
        let [first, last] = [&states[..2], &states[states.len() - dim..][..2]];
        20.0 * (last[0] - first[0]).hypot(last[1] - first[1]) / (states.len() / dim - 1) as f64
    };
    let [walking, racing] = [Some(30.0), None].map(speed);
    assert!((1.1..1.4).contains(&walking) && (4.4..5.6).contains(&racing), "{walking} and {racing} m/s");
}
