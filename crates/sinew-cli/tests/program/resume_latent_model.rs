//! Runs in a latent space are resumed to the same bytes, and with another model not at all.

use crate::common::synthetic::Whole;
use crate::common::walks::one_walk;
use sinew::track::checkpoint;
use sinew_latent::file::LatentKind;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::latent::{LatentRequest, LatentWatch, learn};
use sinew_results::problem::Problem;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Learns from a walk and writes the model.
fn model(folder: &Path, kind: LatentKind, body: NamedBody, steps: usize) -> String {
    let files = one_walk(folder, 0.0, 2.0, body);
    let request =
        LatentRequest { files, kind, dim: 2, rows: 40, balanced: true, back: false, root_per_motion: false, steps };
    let stop = &AtomicBool::new(false);
    let out = folder.join("model.json");
    learn(
        &request,
        &out,
        true,
        &mut LatentWatch { progress: &mut |_, _, _| {}, step: &mut |_| {}, warning: &mut |_| {}, stop },
    )
    .unwrap();
    out.display().to_string()
}

#[test]
fn a_run_in_a_latent_space_stopped_after_a_frame_gives_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, method, body, particles) in [
        (LatentKind::Gpdm, "hmc", NamedBody::H32, None),
        (LatentKind::Gpdm, "gpapf", NamedBody::H32, Some("24")),
        (LatentKind::Hgplvm, "h-apf", NamedBody::Cf28, Some("16")),
        (LatentKind::Hgplvm, "gpapf", NamedBody::Cf28, Some("16")),
    ] {
        let path = model(folder.path(), kind, body, 40);
        let particles = particles.map(|count| ("particles", count));
        let usual = [("method", method), ("body", body.name()), ("latent", &path)];
        let settings: Vec<_> = usual.into_iter().chain(particles).collect();
        let whole = Whole::lasting(8, &settings);
        for stop in [0, 1, 2, 5, 7] {
            whole.check_stopped_at(stop);
        }
    }
}

#[test]
fn a_run_with_another_latent_model_is_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let path = model(folder.path(), LatentKind::Gpdm, NamedBody::H32, 30);
    let whole = Whole::lasting(6, &[("method", "gpapf"), ("latent", &path), ("particles", "16")]);
    let out = whole.folder.path().join("out");
    whole.run(&out, 1, Some(4), None).unwrap();
    model(folder.path(), LatentKind::Gpdm, NamedBody::H32, 31);
    match whole.run(&out, 1, None, Some(checkpoint::read(&out).unwrap())) {
        Err(sinew::Error::Results(sinew_results::Error::Checkpoint { problem, .. })) => {
            let words = problem.to_string();
            assert!(!matches!(*problem, Problem::Settings(_)) && words.contains("latent"), "{words}");
        }
        other => panic!("{other:?}"),
    }
}
