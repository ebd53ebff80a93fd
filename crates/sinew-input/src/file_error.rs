//! A file or folder that cannot be read or written.

use std::io;
use std::path::PathBuf;

/// A file or folder that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {doing} `{}`", path.display())]
pub struct FileError {
    /// Verb of the sentence.
    pub doing: &'static str,
    /// File or folder.
    pub path: PathBuf,
    /// What the system says.
    #[source]
    pub source: io::Error,
}

impl FileError {
    /// Adds verb and path to what the system says: `map_err(FileError::on("read", path))`.
    pub fn on(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self { doing, path, source }
    }
}
