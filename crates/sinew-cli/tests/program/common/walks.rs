//! Recorded walks on disk, and the program that learns from them.

use super::Trial;
use std::fs;

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
