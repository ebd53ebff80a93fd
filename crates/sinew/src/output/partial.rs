//! A file under its provisional name `NAME.partial`, until it is whole.
//!
//! Flushed, synced and checked before the rename: a file under its final name is complete.

use super::storage::{Storage, StoredFile};
use crate::Error;
use std::io::{self, BufWriter, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Provisional name of a file.
#[must_use]
pub(crate) fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

/// A file being written beside its place.
pub(crate) struct PartialFile {
    storage: Arc<dyn Storage>,
    path: PathBuf,
    partial: PathBuf,
    out: BufWriter<Box<dyn StoredFile>>,
}

impl PartialFile {
    pub(crate) fn create(storage: &Arc<dyn Storage>, path: PathBuf) -> Result<Self, Error> {
        let partial = partial_path(&path);
        let file = storage.create(&partial).map_err(Error::io("write", &partial))?;
        Ok(Self { storage: Arc::clone(storage), path, partial, out: BufWriter::new(file) })
    }

    /// A file whose content is at hand.
    pub(crate) fn with_text(storage: &Arc<dyn Storage>, path: PathBuf, text: &str) -> Result<Self, Error> {
        let mut file = Self::create(storage, path)?;
        file.write(|out| out.write_all(text.as_bytes()))?;
        Ok(file)
    }

    /// Appends what the closure writes.
    pub(crate) fn write(
        &mut self,
        write: impl FnOnce(&mut BufWriter<Box<dyn StoredFile>>) -> io::Result<()>,
    ) -> Result<(), Error> {
        write(&mut self.out).map_err(Error::io("write", &self.partial))
    }

    /// Writes over the start of the file.
    pub(crate) fn rewrite_start(
        &mut self,
        write: impl FnOnce(&mut BufWriter<Box<dyn StoredFile>>) -> io::Result<()>,
    ) -> Result<(), Error> {
        self.write(|out| {
            out.seek(SeekFrom::Start(0))?;
            write(out)
        })
    }

    /// Hands everything to the disk and waits for it.
    pub(crate) fn sync(&mut self) -> Result<(), Error> {
        self.write(|out| {
            out.flush()?;
            out.get_mut().sync()
        })
    }

    /// Gives a synced file its name.
    pub(crate) fn rename(self) -> Result<(), Error> {
        self.storage.rename(&self.partial, &self.path).map_err(Error::io("write", &self.path))
    }
}
