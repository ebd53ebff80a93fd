//! Results of one trial on their way into an archive.
//!
//! In memory while they are few bytes, the rest in a folder for temporary files.

use super::memory_first::MemoryFirst;
use crate::Error;
use sinew_results::Storage as _;
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bytes of a trial in memory: some hundred frames.
const IN_MEMORY: usize = 32 << 20;

/// A place for the results of a trial, gone when it is dropped.
pub(super) struct Scratch {
    folder: PathBuf,
    storage: Arc<MemoryFirst>,
}

impl Scratch {
    /// An empty place that nobody else has.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn new() -> Result<Self, Error> {
        static MADE: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = MADE.fetch_add(1, Ordering::Relaxed);
            let folder = std::env::temp_dir().join(format!("sinew-batch-{}-{number}", std::process::id()));
            match fs::create_dir(&folder) {
                Ok(()) => return Ok(Self { folder, storage: Arc::new(MemoryFirst::new(IN_MEMORY)) }),
                // Left behind by a process of the same number that was killed.
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(sinew::Error::io("create", &folder)(error).into()),
            }
        }
    }

    /// Its folder.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// What keeps its files.
    pub(super) const fn storage(&self) -> &Arc<MemoryFirst> {
        &self.storage
    }

    /// Its files, by name.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn files(&self) -> Result<BTreeSet<PathBuf>, Error> {
        let files = self.storage.files_below(&self.folder).map_err(sinew::Error::io("read", &self.folder))?;
        Ok(files.into_iter().collect())
    }

    /// Length and content of a file.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn open(&self, path: &Path) -> io::Result<(u64, Box<dyn Read>)> {
        let mut file = self.storage.read(path)?;
        if let Ok(found) = fs::metadata(path) {
            return Ok((found.len(), file));
        }
        let mut bytes = vec![];
        file.read_to_end(&mut bytes)?;
        Ok((bytes.len() as u64, Box::new(Cursor::new(bytes))))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What stays is in the system's folder for such things.
        let _ = fs::remove_dir_all(&self.folder);
    }
}
