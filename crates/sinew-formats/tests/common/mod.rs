//! The shared recordings, where they are there.

use std::path::Path;

#[path = "../../../../tests/src/data.rs"]
mod shared_data;

pub use shared_data::shared as data;

/// Text of a file of the recordings.
pub fn text(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Rows of a table of check values, without its header.
pub fn rows(table: &str) -> Vec<Vec<String>> {
    table.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}
