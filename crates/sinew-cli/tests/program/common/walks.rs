//! Recorded walks on disk, and the program that learns from them.

use super::Trial;
use sinew::body::points::points_of_states;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::motion_files::MotionFiles;
use sinew_simulate::recording::write_trc;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use std::fs;
use std::path::Path;

const RATE_HZ: f64 = 30.0;

/// A folder with two walks of a number of seconds at 30 frames a second, `a.trc` and `b.trc`.
pub fn walks(duration_s: &str) -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    for (name, seed) in [("a", "1"), ("b", "2")] {
        let arguments = ["simulate", "-o", "made", "--force", "--cameras", "1", "--size", "32x32", "--images", "none"];
        let more = ["--duration", duration_s, "--seed", seed, "--no-progress"];
        let made = trial.run(&[&arguments[..], &more].concat());
        assert!(made.status.success(), "{}", trial.printed(&made));
        fs::rename(trial.path("made/truth.trc"), trial.path(&format!("{name}.trc"))).unwrap();
    }
    fs::remove_dir_all(trial.path("made")).unwrap();
    trial
}

/// What the program prints of learning that succeeds.
pub fn learned(trial: &Trial, learn: &[&str], more: &[&str]) -> String {
    let output = trial.run(&[learn, more].concat());
    assert!(output.status.success(), "{}", trial.printed(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// A walk on disk, to be learned from by a body.
pub fn one_walk(folder: &Path, still_s: f64, duration_s: f64, body: NamedBody) -> MotionFiles {
    let walker = Walker::new(Gait { still_s, duration_s, ..Gait::default() });
    let motion = points_of_states(&walker.body, &walker_states(&walker, RATE_HZ));
    let mut bytes = vec![];
    write_trc(&mut bytes, "walk.trc", &motion, RATE_HZ).unwrap();
    let path = folder.join("walk.trc");
    fs::write(&path, bytes).unwrap();
    MotionFiles { motion: vec![path], held_out: vec![], skeleton: None, amc_hz: None, body, fps: RATE_HZ }
}
