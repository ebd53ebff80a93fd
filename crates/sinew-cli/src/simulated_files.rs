//! What a simulated recording consists of: its files and folders, and the command that tracks it.

use std::fs;
use std::path::{Path, PathBuf};

/// Duration of a walk, seconds.
pub(crate) const WALK_S: f64 = 4.0;
/// Folders of the recording.
pub(crate) const FOLDERS: [&str; 3] = ["keypoints", "masks", "images"];
pub(crate) const TRUTH: &str = "truth.trc";
pub(crate) const CALIBRATION: &str = "Calib.toml";
pub(crate) const README: &str = "README.txt";

/// Writes a file.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), sinew::Error> {
    fs::write(path, bytes).map_err(sinew::Error::io("write", path))
}

/// Takes away what a former run wrote here, and makes the folders that this one fills.
pub(crate) fn clear(out: &Path, filled: &[&str]) -> Result<(), sinew::Error> {
    for path in [README, TRUTH, CALIBRATION].map(|name| out.join(name)) {
        if path.exists() {
            fs::remove_file(&path).map_err(sinew::Error::io("replace", &path))?;
        }
    }
    let is_truth = |path: &PathBuf| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("truth_"));
    let entries = fs::read_dir(out).map_err(sinew::Error::io("read", out))?;
    for path in entries.flatten().map(|entry| entry.path()).filter(is_truth) {
        fs::remove_file(&path).map_err(sinew::Error::io("replace", &path))?;
    }
    for path in FOLDERS.map(|name| out.join(name)) {
        if path.exists() {
            fs::remove_dir_all(&path).map_err(sinew::Error::io("replace", &path))?;
        }
    }
    for path in filled.iter().map(|name| out.join(name)) {
        fs::create_dir_all(&path).map_err(sinew::Error::io("create", &path))?;
    }
    Ok(())
}

/// A number of cameras, in words.
pub(crate) fn cameras(count: usize) -> String {
    if count == 1 { "1 camera".into() } else { format!("{count} cameras") }
}

/// The command that tracks the recording in a folder.
pub(crate) fn track_command(folder: &str, fps: f64) -> String {
    format!(
        "sinew track --calibration {folder}/{CALIBRATION} --keypoints {folder}/{} --layout BODY_25B --fps {fps} -o {folder}-track",
        FOLDERS[0]
    )
}
