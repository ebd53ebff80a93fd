//! The few operations on files that results need, as a trait.
//!
//! A test can let any of them fail.

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A file being written.
pub trait StoredFile: Write + Seek + Send {
    /// Hands what was written to the disk and waits for it.
    ///
    /// # Errors
    /// Errors of the system.
    fn sync(&mut self) -> io::Result<()>;
}

impl StoredFile for fs::File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// A place for files.
pub trait Storage: std::fmt::Debug + Send + Sync {
    /// Creates a folder and those above it.
    ///
    /// # Errors
    /// Errors of the system.
    fn create_folder(&self, path: &Path) -> io::Result<()>;

    /// Creates a file, in place of one or of a link that may be there: a link is never followed.
    ///
    /// # Errors
    /// Errors of the system.
    fn create(&self, path: &Path) -> io::Result<Box<dyn StoredFile>>;

    /// Opens a file that is there, cut to `length` bytes, at its end.
    ///
    /// # Errors
    /// Errors of the system.
    fn resume(&self, path: &Path, length: u64) -> io::Result<Box<dyn StoredFile>>;

    /// Opens a file for reading.
    ///
    /// # Errors
    /// Errors of the system.
    fn read(&self, path: &Path) -> io::Result<Box<dyn Read>>;

    /// Whether there is a file or folder.
    fn exists(&self, path: &Path) -> bool;

    /// Hands a written and closed file, or the names in a folder, to the disk and waits for it.
    ///
    /// # Errors
    /// Errors of the system.
    fn sync(&self, path: &Path) -> io::Result<()>;

    /// Renames a file or folder, over a file that may be there.
    ///
    /// # Errors
    /// Errors of the system.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Removes a file or a folder with all in it; none there is no error.
    ///
    /// # Errors
    /// Errors of the system.
    fn remove(&self, path: &Path) -> io::Result<()>;

    /// All files below a folder, in any order; links are not followed.
    ///
    /// # Errors
    /// Errors of the system.
    fn files_below(&self, folder: &Path) -> io::Result<Vec<PathBuf>>;

    /// Whether nothing that is stopped here is ever continued.
    fn is_temporary(&self) -> bool {
        false
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Storage for Disk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }

    fn create(&self, path: &Path) -> io::Result<Box<dyn StoredFile>> {
        let new = || fs::File::options().read(true).write(true).create_new(true).open(path);
        let created = new().or_else(|error| match error.kind() {
            io::ErrorKind::AlreadyExists => fs::remove_file(path).and_then(|()| new()),
            _ => Err(error),
        });
        Ok(Box::new(created?))
    }

    fn resume(&self, path: &Path, length: u64) -> io::Result<Box<dyn StoredFile>> {
        let mut file = fs::File::options().read(true).write(true).open(path)?;
        file.set_len(length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Box::new(file))
    }

    fn read(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        Ok(Box::new(io::BufReader::new(sinew_input::files::open(path)?)))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        match path.as_os_str().is_empty() || path.is_dir() {
            true => sync_folder(path),
            false => fs::File::options().append(true).open(path)?.sync_all(),
        }
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        let result = match fs::symlink_metadata(path) {
            Ok(found) if found.is_dir() => fs::remove_dir_all(path),
            Ok(_) => fs::remove_file(path),
            Err(error) => Err(error),
        };
        match result {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            other => other,
        }
    }

    fn files_below(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        files_below(folder)
    }
}

/// All files below a folder; links are not followed.
pub(crate) fn files_below(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = vec![];
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        match entry.file_type()?.is_dir() {
            true => files.extend(files_below(&entry.path())?),
            false => files.push(entry.path()),
        }
    }
    Ok(files)
}

/// The file system without waiting for the disk: whoever keeps what was written waits for all of it at once ([`sync_below`]).
#[derive(Clone, Copy, Debug, Default)]
pub struct UnsyncedDisk;

/// A file that is never waited for.
struct UnsyncedFile(Box<dyn StoredFile>);

impl Write for UnsyncedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Seek for UnsyncedFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

impl StoredFile for UnsyncedFile {
    fn sync(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl Storage for UnsyncedDisk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        Disk.create_folder(path)
    }
    fn create(&self, path: &Path) -> io::Result<Box<dyn StoredFile>> {
        Ok(Box::new(UnsyncedFile(Disk.create(path)?)))
    }
    fn resume(&self, path: &Path, length: u64) -> io::Result<Box<dyn StoredFile>> {
        Ok(Box::new(UnsyncedFile(Disk.resume(path, length)?)))
    }
    fn read(&self, path: &Path) -> io::Result<Box<dyn Read>> {
        Disk.read(path)
    }
    fn exists(&self, path: &Path) -> bool {
        Disk.exists(path)
    }
    fn sync(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        Disk.rename(from, to)
    }
    fn remove(&self, path: &Path) -> io::Result<()> {
        Disk.remove(path)
    }
    fn files_below(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        files_below(folder)
    }
}

/// Waits until everything on the file system of a folder is on the disk: for many small files a tenth of the time of waiting for each.
///
/// # Errors
/// Errors of the system, also of files that were written before.
#[cfg(target_os = "linux")]
pub fn sync_below(folder: &Path) -> io::Result<()> {
    Ok(rustix::fs::syncfs(fs::File::open(folder)?)?)
}

/// Waits until everything below a folder is on the disk.
///
/// # Errors
/// Errors of the system.
#[cfg(not(target_os = "linux"))]
pub fn sync_below(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { sync_below(&path)? } else { Disk.sync(&path)? }
    }
    sync_folder(folder)
}

/// A name is safe when its folder is synced; "" is the present folder.
#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    match fs::File::open(path).and_then(|folder| folder.sync_all()) {
        // A folder that may be written and not read; a file system that knows no such thing.
        Err(error) if matches!(error.kind(), InvalidInput | PermissionDenied | Unsupported) => Ok(()),
        synced => synced,
    }
}

/// Elsewhere folders cannot be opened.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}
