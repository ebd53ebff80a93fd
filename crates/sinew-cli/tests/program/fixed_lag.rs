//! Fixed-lag smoothing lies between the filter and the smoother, and has both as its ends.

use crate::common::synthetic::{FRAMES, Whole};
use std::collections::BTreeMap;

/// The numbers of a run: what does not name its kind or its settings.
fn numbers(files: &BTreeMap<String, Vec<u8>>) -> BTreeMap<&str, &Vec<u8>> {
    let is_number = |name: &&str| !name.ends_with(".json") && !name.ends_with(".toml");
    files.iter().map(|(name, bytes)| (name.as_str(), bytes)).filter(|(name, _)| is_number(name)).collect()
}

#[test]
fn a_lag_of_the_whole_recording_is_the_smoother_and_none_is_the_filter() {
    let whole = |settings: &[(&'static str, &str)]| Whole::new(settings).files;
    let smoothed = whole(&[("smooth", "true")]);
    let lagged = whole(&[("lag_frames", "1000")]);
    assert!(numbers(&smoothed).len() > 10 && numbers(&lagged) == numbers(&smoothed));
    assert!(numbers(&whole(&[("lag_frames", "0")])) == numbers(&whole(&[])));
    let some = whole(&[("lag_frames", "4")]);
    assert!(some["joints.csv"] != smoothed["joints.csv"]);
    // The last frame has no later one in either.
    let last = |files: &BTreeMap<String, Vec<u8>>| {
        let text = String::from_utf8_lossy(&files["state.csv"]).into_owned();
        text.lines().filter(|line| line.starts_with(&format!("{},", FRAMES - 1))).collect::<Vec<_>>().join("\n")
    };
    assert!(!last(&some).is_empty() && last(&some) == last(&smoothed));
    assert!(String::from_utf8_lossy(&some["summary.json"]).contains("\"kind\": \"fixed-lag\""));
}
