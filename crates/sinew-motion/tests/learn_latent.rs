//! Learning of latent models from the files of a synthetic walk: stopped runs continue to the same bytes.

use sinew_body::points::points_of_states;
use sinew_latent::file::{LatentKind, read};
use sinew_motion::Error;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::latent::{LatentRequest, LatentWatch, LearnedLatent, learn};
use sinew_motion::learn::motion_files::{LearnPhase, MotionFiles};
use sinew_simulate::recording::write_trc;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// A walk of two seconds at 40 frames a second as a TRC file.
fn walk(folder: &Path, name: &str, stride_s: f64) -> PathBuf {
    let walker = Walker::new(Gait { still_s: 0.0, stride_s, duration_s: 2.0, ..Gait::default() });
    let motion = points_of_states(&walker.body, &walker_states(&walker, 40.0));
    let path = folder.join(name);
    let mut bytes = Vec::new();
    write_trc(&mut bytes, name, &motion, 40.0).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

fn request(folder: &Path, kind: LatentKind) -> LatentRequest {
    let files = MotionFiles {
        motion: vec![walk(folder, "a.trc", 1.1), walk(folder, "b.trc", 1.25)],
        held_out: vec![walk(folder, "c.trc", 1.2)],
        skeleton: None,
        amc_hz: None,
        body: NamedBody::Cf28,
        fps: 20.0,
    };
    LatentRequest { files, kind, dim: 3, rows: 40, balanced: true, back: false, root_per_motion: false, steps: 56 }
}

/// Learns, and stops after that many steps.
fn run(request: &LatentRequest, out: &Path, most: u64) -> Result<LearnedLatent, Error> {
    let stop = AtomicBool::new(false);
    let mut progress = |phase, done, _| {
        if phase == LearnPhase::Learn && done >= most {
            stop.store(true, Ordering::SeqCst);
        }
    };
    learn(
        request,
        out,
        true,
        &mut LatentWatch { progress: &mut progress, step: &mut |_| {}, warning: &mut |_| {}, stop: &stop },
    )
}

#[test]
fn a_stopped_run_continues_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, parts) = (folder.path().join("whole.json"), folder.path().join("parts.json"));
    for kind in LatentKind::ALL {
        let request = request(folder.path(), kind);
        let learned = run(&request, &whole, u64::MAX).unwrap();
        assert_eq!((learned.lengths.as_slice(), learned.available), (&[20, 20][..], 80), "{kind}");
        let expected = fs::read(&whole).unwrap();
        assert_eq!(read("whole", &String::from_utf8(expected.clone()).unwrap()).ok(), learned.model, "{kind}");
        let stored = learned.model.unwrap();
        assert_eq!((stored.state.as_str(), stored.free, stored.model.columns), ("cf28", 6, 22));
        for most in [7, 53] {
            let stopped = run(&request, &parts, most).unwrap();
            assert!(
                stopped.model.is_none() && !parts.exists() && stopped.progress.steps as u64 >= most,
                "{kind}, {most}"
            );
        }
        let ended = run(&request, &parts, u64::MAX).unwrap();
        assert_eq!(fs::read(&parts).unwrap(), expected, "{kind}");
        assert_eq!((ended.warnings.len(), ended.progress), (0, learned.progress), "{kind}");
        assert!(!folder.path().join("parts.json.unfinished").exists());
        fs::remove_file(&parts).unwrap();
    }
}

#[test]
fn unfinished_runs_of_others_are_not_continued() {
    let folder = tempfile::tempdir().unwrap();
    let (out, request) = (folder.path().join("m.json"), request(folder.path(), LatentKind::Gpdm));
    let unfinished = folder.path().join("m.json.unfinished");
    run(&request, &out, 7).unwrap();
    let text = fs::read_to_string(&unfinished).unwrap();
    for other in [
        LatentRequest { dim: 2, ..request.clone() },
        LatentRequest { balanced: false, ..request.clone() },
        LatentRequest { rows: 30, ..request.clone() },
        LatentRequest { steps: 8, ..request.clone() },
    ] {
        let warnings = run(&other, &out, 1).unwrap().warnings;
        assert!(warnings[0].contains("belongs to other motion or settings"), "{warnings:?}");
        fs::write(&unfinished, &text).unwrap();
    }
    for broken in [text.replacen("\"steps\":", "\"steps\":1", 1), text[..text.len() / 2].to_owned(), String::new()] {
        fs::write(&unfinished, broken).unwrap();
        let warnings = run(&request, &out, 1).unwrap().warnings;
        assert!(warnings[0].contains("is damaged; all is learned again"), "{warnings:?}");
    }
}

/// The angles of H32 but for its feet, the last four.
#[test]
fn feet_are_not_in_the_model() {
    let folder = tempfile::tempdir().unwrap();
    for kind in [LatentKind::Gplvm, LatentKind::Hgplvm] {
        let mut request = request(folder.path(), kind);
        request.files.body = NamedBody::H32;
        let learned = run(&request, &folder.path().join("m.json"), u64::MAX).unwrap();
        let stored = learned.model.unwrap();
        assert_eq!((stored.free, stored.model.columns, NamedBody::H32.tree().dof()), (6, 22, 32));
        assert!(learned.warnings.is_empty(), "{:?}", learned.warnings);
    }
}

#[test]
fn poses_come_back_through_the_model() {
    let folder = tempfile::tempdir().unwrap();
    for (kind, root_per_motion) in [(LatentKind::Gpdm, false), (LatentKind::Hgplvm, false), (LatentKind::Hgplvm, true)]
    {
        let out = folder.path().join("m.json");
        let request = LatentRequest { root_per_motion, ..request(folder.path(), kind) };
        let learned = run(&request, &out, u64::MAX).unwrap();
        let degrees = learned.reconstruction.map(|found| found.unwrap().rms_rad.to_degrees());
        println!("{kind}, root per motion: {root_per_motion}: {degrees:?} degrees");
        assert!(degrees[0] < 2.0 && degrees[1] < 5.0, "{kind}: {degrees:?}");
        let roots = learned.model.unwrap().model.roots().len();
        assert_eq!(roots, if root_per_motion { 2 } else { 1 });
    }
}
