//! The shared recordings, where they are there.

use std::path::{Path, PathBuf};

/// Folder of the recordings: `SINEW_DATA`, or `shared/data` beside the workspace.
pub fn data(part: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SINEW_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    let folder = folder.join(part);
    if !folder.is_dir() {
        println!("skipped: no data");
        return None;
    }
    Some(folder)
}

/// Text of a file of the recordings.
pub fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Rows of a table of check values, without its header.
pub fn rows(table: &str) -> Vec<Vec<String>> {
    table.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}
