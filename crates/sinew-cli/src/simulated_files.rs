//! What a simulated recording consists of: its files and folders, and the command that tracks it.

/// Duration of a walk, seconds.
pub(crate) const WALK_S: f64 = 4.0;
/// Folders of the recording.
pub(crate) const FOLDERS: [&str; 3] = ["keypoints", "masks", "images"];
pub(crate) const TRUTH: &str = "truth.trc";
pub(crate) const CALIBRATION: &str = "Calib.toml";
pub(crate) const README: &str = "README.txt";

/// Whether a file of a folder belongs to a recording that an earlier run left, and goes when there is a new one.
pub(crate) fn is_of_recording(name: &str) -> bool {
    let in_folder = name.split_once('/').is_some_and(|(folder, _)| FOLDERS.contains(&folder));
    in_folder || [README, TRUTH, CALIBRATION].contains(&name) || (name.starts_with("truth_") && name.ends_with(".trc"))
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
