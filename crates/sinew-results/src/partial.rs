//! A file under its provisional name `NAME.partial`, until it is whole.
//!
//! Flushed, synced and checked before the rename: a file under its final name is complete.
//!
//! While a file grows, its length and a checksum of what was written are known ([`Position`]). A run that is resumed compares them with what is there, cuts what came later, and writes on
//! behind it. A header that is rewritten at the end, when the number of frames is known, is put back first.

use crate::Error;
use crate::problem::Problem;
use crate::storage::{Disk, Storage, StoredFile};
use serde::{Deserialize, Serialize};
use sinew_formats::tidy_csv::{Cell, write_header, write_row};
use std::collections::BTreeMap;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Provisional name of a file.
#[must_use]
pub(crate) fn partial_path(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

/// How far a file was written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Position {
    /// Bytes.
    pub length: u64,
    /// CRC-32 of them.
    pub checksum: u32,
}

/// Where the files of a run are, and how far they were written if the run is resumed.
pub struct FilePlace<'a> {
    /// Where files are kept.
    pub storage: &'a Arc<dyn Storage>,
    /// Folder of the results.
    pub folder: &'a Path,
    /// How far the files of a stopped run go, by name; nothing for a new run.
    pub written: Option<&'a BTreeMap<String, Position>>,
}

impl FilePlace<'_> {
    /// A file that begins with a header: a new one, or the one that is there.
    pub fn file(&self, name: &str, header: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<PartialFile, Error> {
        let path = self.folder.join(name);
        let mut first = Vec::new();
        header(&mut first).map_err(Error::io("write", &path))?;
        match self.written {
            None => {
                let mut file = PartialFile::create(self.storage, path)?;
                file.write(|out| out.write_all(&first))?;
                Ok(file)
            }
            Some(written) => {
                let at = written.get(name).copied().unwrap_or_default();
                PartialFile::resume(self.storage, path, at, &first)
            }
        }
    }

    /// A comma-separated table that begins with its columns.
    pub(crate) fn table(&self, name: &str, columns: &[impl AsRef<str>]) -> Result<PartialFile, Error> {
        self.file(name, |out| write_header(out, columns))
    }
}

/// A stream that knows how much went through it, and its checksum.
pub struct Counted {
    file: Box<dyn StoredFile>,
    length: u64,
    checksum: crc32fast::Hasher,
}

impl Write for Counted {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.length += written as u64;
        self.checksum.update(&bytes[..written]);
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A file being written beside its place.
pub struct PartialFile {
    storage: Arc<dyn Storage>,
    path: PathBuf,
    partial: PathBuf,
    out: BufWriter<Counted>,
}

impl PartialFile {
    /// A new file under its provisional name.
    ///
    /// # Errors
    /// What the system says, with the path.
    pub fn create(storage: &Arc<dyn Storage>, path: PathBuf) -> Result<Self, Error> {
        let partial = partial_path(&path);
        Self::create_as(storage, path, partial)
    }

    /// A new file under a provisional name that nobody has: outside of folders of results, a file of the usual one may be somebody else's.
    pub(crate) fn create_beside(storage: &Arc<dyn Storage>, path: PathBuf) -> Result<Self, Error> {
        let (mut partial, mut number) = (partial_path(&path), 1);
        while partial.symlink_metadata().is_ok() {
            number += 1;
            let mut name = path.as_os_str().to_owned();
            name.push(format!(".{number}"));
            partial = partial_path(Path::new(&name));
        }
        Self::create_as(storage, path, partial)
    }

    fn create_as(storage: &Arc<dyn Storage>, path: PathBuf, partial: PathBuf) -> Result<Self, Error> {
        let file = storage.create(&partial).map_err(Error::io("write", &partial))?;
        let out = BufWriter::new(Counted { file, length: 0, checksum: crc32fast::Hasher::new() });
        Ok(Self { storage: Arc::clone(storage), path, partial, out })
    }

    /// A file that is there, as far as it was written, with `header` for its first bytes.
    fn resume(storage: &Arc<dyn Storage>, path: PathBuf, at: Position, header: &[u8]) -> Result<Self, Error> {
        let partial = take_back(storage, &path)?;
        let mut checksum = crc32fast::Hasher::new();
        checksum.update(header);
        let rest = at.length.checked_sub(header.len() as u64);
        let found = storage.read(&partial).and_then(|mut file| {
            io::copy(&mut (&mut file).take(header.len() as u64), &mut io::sink())?;
            checksum_of(&mut file.take(rest.unwrap_or(0)), &mut checksum)
        });
        let found = found.map_err(Error::io("read", &partial))?;
        if Some(found) != rest || checksum.clone().finalize() != at.checksum {
            return Err(Error::checkpoint(path.parent().unwrap_or(Path::new("")), Problem::Changed { path: partial }));
        }
        let open = || {
            let mut file = storage.resume(&partial, at.length)?;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(header)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(Error::io("write", &partial))?;
        let out = BufWriter::new(Counted { file, length: at.length, checksum });
        Ok(Self { storage: Arc::clone(storage), path, partial, out })
    }

    /// A file whose content is at hand.
    pub fn with_text(storage: &Arc<dyn Storage>, path: PathBuf, text: &str) -> Result<Self, Error> {
        let mut file = Self::create(storage, path)?;
        file.write(|out| out.write_all(text.as_bytes()))?;
        file.flush()?;
        Ok(file)
    }

    /// Appends what the closure writes.
    pub fn write(&mut self, write: impl FnOnce(&mut BufWriter<Counted>) -> io::Result<()>) -> Result<(), Error> {
        write(&mut self.out).map_err(Error::io("write", &self.partial))
    }

    /// Appends a row of a table.
    pub(crate) fn row(&mut self, cells: &[Cell<'_>]) -> Result<(), Error> {
        self.write(|out| write_row(out, cells))
    }

    /// Writes over the start of the file; nothing is appended any more.
    pub fn rewrite_start(&mut self, header: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<(), Error> {
        let mut first = Vec::new();
        let rewrite = || {
            header(&mut first)?;
            self.out.flush()?;
            let file = &mut self.out.get_mut().file;
            file.seek(SeekFrom::Start(0))?;
            file.write_all(&first)
        };
        rewrite().map_err(Error::io("write", &self.partial))
    }

    /// Hands everything to the disk and waits for it.
    pub fn sync(&mut self) -> Result<(), Error> {
        self.flush()?;
        self.out.get_mut().file.sync().map_err(Error::io("write", &self.partial))
    }

    fn flush(&mut self) -> Result<(), Error> {
        self.out.flush().map_err(Error::io("write", &self.partial))
    }

    /// Hands everything to the disk, and says how much that is.
    pub fn keep(&mut self) -> Result<(String, Position), Error> {
        self.sync()?;
        let Counted { length, checksum, .. } = self.out.get_ref();
        Ok((self.name(), Position { length: *length, checksum: checksum.clone().finalize() }))
    }

    /// Everything written so far.
    pub fn read_back(&mut self) -> Result<Box<dyn Read>, Error> {
        self.flush()?;
        self.storage.read(&self.partial).map_err(Error::io("read", &self.partial))
    }

    /// The name that it will have.
    pub(crate) fn name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Gives a synced file its name.
    pub fn rename(self) -> Result<(), Error> {
        self.storage.rename(&self.partial, &self.path).map_err(Error::io("write", &self.path))
    }
}

/// The provisional name of a file or folder; where it has its final name already, since the run was interrupted or stopped while it gave them, that is taken back.
pub(crate) fn take_back(storage: &Arc<dyn Storage>, path: &Path) -> Result<PathBuf, Error> {
    let partial = partial_path(path);
    if !partial.exists() && path.exists() {
        storage.rename(path, &partial).map_err(Error::io("write", &partial))?;
    }
    Ok(partial)
}

/// Adds a stream to a checksum; gives its length.
pub(crate) fn checksum_of(stream: &mut impl Read, checksum: &mut crc32fast::Hasher) -> io::Result<u64> {
    let mut buffer = vec![0; 1 << 16];
    let mut length = 0;
    loop {
        match stream.read(&mut buffer)? {
            0 => return Ok(length),
            read => {
                checksum.update(&buffer[..read]);
                length += read as u64;
            }
        }
    }
}

/// Writes a single file beside its place, and renames it once it is whole; then both are on the disk.
///
/// # Errors
/// A file that cannot be read or written with the path.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let disk: Arc<dyn Storage> = Arc::new(Disk);
    whole(&disk, PartialFile::create_beside(&disk, path.to_owned())?, path, bytes)
}

/// As [`write_whole`], in the given storage, for a file of a claimed folder: `NAME.partial` is ours.
pub fn write_whole_in(storage: &Arc<dyn Storage>, path: &Path, bytes: &[u8]) -> Result<(), Error> {
    whole(storage, PartialFile::create(storage, path.to_owned())?, path, bytes)
}

fn whole(storage: &Arc<dyn Storage>, mut file: PartialFile, path: &Path, bytes: &[u8]) -> Result<(), Error> {
    file.write(|out| out.write_all(bytes))?;
    file.sync()?;
    file.rename()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    storage.sync(folder).map_err(Error::io("write", folder))
}
