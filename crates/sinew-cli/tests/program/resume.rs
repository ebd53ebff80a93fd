//! A run that was stopped is resumed to the same bytes, and a damaged checkpoint is refused.

use crate::common::column;
use crate::common::synthetic::{FRAMES, Whole, results};
use sinew::input::upright::{FramesRead, Upright};
use sinew::track::checkpoint::{self, Checkpoint};
use sinew_results::problem;
use sinew_results::problem::Problem;
use std::fs;
use std::path::Path;

/// Frames of a run that is stopped after each of them.
const SHORT: u64 = 12;

/// Every frame, both methods, with another number of threads.
#[test]
fn a_run_stopped_after_any_frame_gives_the_same_files() {
    for method in ["hmc", "bootstrap"] {
        let whole = Whole::lasting(SHORT, &[("method", method)]);
        for stop in 0..=SHORT {
            whole.check_stopped_at(stop);
        }
    }
}

/// Where the noise is wide, few particles continue from frame to frame, so that their states and weights decide on what follows.
#[test]
fn a_particle_filter_that_continues_is_resumed_to_the_same_files() {
    let whole = Whole::blurred(12, &[("method", "bootstrap"), ("body", "cf28")], 20.0);
    let restarted = column(&whole.files["frames.csv"], "restarted");
    assert!(restarted.iter().skip(1).all(|restarted| restarted == "0"), "{restarted:?}");
    for stop in [1, 5, 11] {
        whole.check_stopped_at(stop);
    }
}

/// The same from silhouettes, by searches: what they remember is resumed, too.
#[test]
fn a_run_on_silhouettes_stopped_after_any_frame_gives_the_same_files() {
    for method in ["annealed", "hppf", "coarse-to-fine"] {
        let few = [("method", method), ("particles", "8"), ("fine", "8"), ("layers", "2"), ("raster", "64")];
        let whole = Whole::from_silhouettes(SHORT, &few);
        for stop in 0..=SHORT {
            whole.check_stopped_at(stop);
        }
    }
}

/// The same with pictures and a set-up that learns their colours, before a frame with a picture and before one without.
#[test]
fn a_run_on_colours_stopped_after_a_frame_gives_the_same_files() {
    for method in ["hppf", "partitioned"] {
        let few = [("method", method), ("particles", "8"), ("score", "parts"), ("raster", "64")];
        let whole = Whole::from_pictures(SHORT, &few);
        for stop in [1, 6] {
            whole.check_stopped_at(stop);
        }
    }
}

/// As above through the backward pass, every fifth frame and the last.
#[test]
fn a_smoothed_run_stopped_after_a_frame_gives_the_same_files() {
    for method in ["hmc", "bootstrap"] {
        let whole = Whole::new(&[("method", method), ("smooth", "true")]);
        for stop in (0..=FRAMES).step_by(5) {
            whole.check_stopped_at(stop);
        }
    }
}

/// As above with a fixed lag, in whose window frames wait at every stop.
#[test]
fn a_run_with_a_fixed_lag_stopped_after_a_frame_gives_the_same_files() {
    for (method, lag) in [("hmc", "4"), ("bootstrap", "1")] {
        let whole = Whole::new(&[("method", method), ("lag_frames", lag)]);
        for stop in [1, 3, 6, 17, FRAMES] {
            whole.check_stopped_at(stop);
        }
    }
}

/// A checkpoint after every frame or never: the numbers are the same.
#[test]
fn checkpoints_change_no_number() {
    let of = |every| {
        let mut files = Whole::new(&[("checkpoint_every", every)]).files;
        // It names the folder of the set-up, which is another one.
        assert!(files.remove("config.toml").is_some());
        files
    };
    let [always, never] = ["0", "1e9"].map(of);
    assert!(always.len() > 10 && always == never);
}

/// Cut anywhere and flipped in any byte, a checkpoint is refused by name; the bits are flipped in turn.
#[test]
fn a_cut_or_flipped_checkpoint_is_refused() {
    let whole = Whole::new(&[("method", "bootstrap"), ("particles", "8"), ("draws", "1"), ("body", "cf28")]);
    let out = whole.folder.path().join("out");
    whole.run(&out, 1, Some(2), None).unwrap();
    let bytes = fs::read(out.join(problem::NAME)).unwrap();
    let decoded = Checkpoint::decode(&bytes).unwrap();
    assert!(decoded.done == 2 && decoded.encode().unwrap() == bytes);
    for end in 0..bytes.len() {
        assert!(matches!(Checkpoint::decode(&bytes[..end]), Err(Problem::Length { .. })), "{end}");
    }
    let mut changed = bytes.clone();
    for at in 0..bytes.len() {
        changed[at] ^= 1 << (at % 8);
        let problem = Checkpoint::decode(&changed).unwrap_err();
        let expected = match at {
            0..16 => matches!(problem, Problem::Foreign),
            20..28 => matches!(problem, Problem::Length { .. }),
            _ => matches!(problem, Problem::Checksum { .. }),
        };
        assert!(expected, "byte {at}: {problem:?}");
        changed[at] = bytes[at];
    }
    let longer = [&bytes[..], b"x"].concat();
    assert!(matches!(Checkpoint::decode(&longer), Err(Problem::Length { .. })));
}

/// A bit flipped in any whole chunk of the draws, or a chunk removed, is refused by name; as it was, the run resumes to the same files.
#[test]
fn a_changed_or_missing_chunk_is_refused() {
    let settings = [("method", "bootstrap"), ("particles", "8"), ("draws", "1"), ("body", "cf28")];
    let whole = Whole::lasting(150, &settings);
    let out = whole.folder.path().join("out");
    whole.run(&out, 1, Some(130), None).unwrap();
    let refused = |path: &Path| {
        let from = checkpoint::read(&out).unwrap();
        assert_eq!(from.done, 130);
        match whole.run(&out, 1, None, Some(from)) {
            Err(sinew::Error::Results(sinew_results::Error::Checkpoint { problem, .. })) => {
                assert_eq!(*problem, Problem::Changed { path: path.to_owned() });
            }
            other => panic!("{}: {other:?}", path.display()),
        }
    };
    // The run that was interrupted gave the store its name; the resumed run takes that back.
    let [named, store] = ["posterior.zarr", "posterior.zarr.partial"].map(|name| out.join(name));
    let arrays: Vec<(&str, Vec<usize>)> = vec![
        ("posterior/angle", vec![0, 0, 1, 0]),
        ("posterior/root", vec![0, 0, 0, 0]),
        ("posterior/marker_position", vec![0, 0, 1, 0, 0]),
        ("posterior/frame", vec![0]),
        ("posterior/time", vec![1]),
        ("sample_stats/ess", vec![0, 0]),
        ("sample_stats/log_weight", vec![0, 0, 1]),
        ("observed_data/pixel", vec![1, 0, 0, 0]),
        ("observed_data/confidence", vec![0, 0, 0]),
    ];
    for (bit, (array, indices)) in arrays.into_iter().enumerate() {
        let key = indices.iter().fold(format!("{array}/c"), |key, index| format!("{key}.{index}"));
        let path = if store.exists() { store.join(&key) } else { named.join(&key) };
        let bytes = fs::read(&path).unwrap();
        let mut flipped = bytes.clone();
        flipped[bytes.len() / 2] ^= 1 << (bit % 8);
        fs::write(&path, &flipped).unwrap();
        let path = store.join(&key);
        refused(&path);
        fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        refused(&path);
        fs::remove_file(&path).unwrap();
        refused(&path);
        fs::write(&path, &bytes).unwrap();
    }
    let from = checkpoint::read(&out).unwrap();
    assert!(whole.run(&out, 2, None, Some(from)).unwrap().summary.complete);
    assert!(results(&out) == whole.files);
}

/// Frames that the set-up and the tracker both read are counted once when they are read again.
#[test]
fn frames_read_again_are_counted_once() {
    let whole = Whole::new(&[("method", "bootstrap"), ("particles", "8"), ("draws", "1"), ("body", "cf28")]);
    let mut recording = whole.recording.clone();
    let mut source = Upright::new(&mut recording, "+z");
    let mut printed = vec![];
    let each = |done, total| {
        printed.push((done, total));
        Ok::<_, sinew::Error>(())
    };
    let read = FramesRead { people: vec![0..20, 5..6, 28..40], masks: vec![], pictures: vec![] };
    source.read_again(&read, 0..30, each).unwrap();
    assert_eq!(printed, (1..=FRAMES).map(|done| (done, FRAMES)).collect::<Vec<_>>());
}
