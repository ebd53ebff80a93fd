//! The right to write into a folder, sought before any computing.
//!
//! 1. The folder must not be, hold or lie in an input folder.
//! 2. The folder may be written over if it is empty, if it holds the remains of a run that was stopped and left no checkpoint (`summary.json` says `complete: false`, or there are only
//!    `*.partial`), or if the user says so. A run that is resumed takes the folder as it was left ([`claim_to_resume`]).
//! 3. The folder is created and a lock file with our process number is put into it. The system gives the lock back when the process ends, however it ends; a lock file
//!    without a lock is a remnant, and taken over.
//! 4. Folders that were created and in which nothing was left are removed again.

use super::problem::{self, Problem};
use super::results_error::Occupied;
use crate::Error;
use crate::own_files::{LIST_NAME, LOCK_NAME, listed, refuse_others};
use crate::place::place;
use crate::storage::{Disk, Storage};
use std::fs::{self, File, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Everything that a run leaves in its folder.
pub const RESULT_NAMES: [&str; 15] = [
    "angles.csv",
    "angles.mot",
    "config.toml",
    "frames.csv",
    "joints.csv",
    "keypoints.csv",
    "load.py",
    "markers.trc",
    "markers_sd.csv",
    "motion.bvh",
    "posterior.zarr",
    "setup.toml",
    "state.csv",
    "summary.json",
    "timings.json",
];

/// What a run keeps in its folder to be resumed from; removed when it is complete, in this order.
pub const OWN_NAMES: [&str; 6] = [
    "diagnostics.partial",
    "chunks.partial",
    "smooth.partial",
    "trajectories.partial",
    "checkpoint.bin.partial",
    problem::NAME,
];

/// A folder that this process alone may write.
#[must_use]
pub struct Claim {
    pub(crate) folder: PathBuf,
    pub(crate) storage: Arc<dyn Storage>,
    lock: Option<File>,
    _made: Made,
    /// Process that left its lock behind, if there was one.
    pub stale_lock_of: Option<u32>,
    /// Whether a run was stopped here that can be resumed.
    pub is_resumable: bool,
}

/// Folders that were created, the deepest first. Those that are empty at the end are removed.
#[derive(Default)]
struct Made(Vec<PathBuf>);

impl Drop for Made {
    fn drop(&mut self) {
        // The first that is not empty keeps all above it.
        let _ = self.0.iter().try_for_each(fs::remove_dir);
    }
}

/// Claims a folder for results.
///
/// # Errors
/// [`Error::OutputIsInput`], [`Error::OutputExists`], [`Error::OutputLocked`], and a file that cannot be read or written for a folder that cannot be written.
pub fn claim(folder: &Path, inputs: &[PathBuf], force: bool) -> Result<Claim, Error> {
    claim_in(Arc::new(Disk), folder, inputs, force)
}

/// As [`claim`], with files kept in the given storage (the lock is always on the disk).
///
/// # Errors
/// As [`claim`].
pub fn claim_in(storage: Arc<dyn Storage>, folder: &Path, inputs: &[PathBuf], force: bool) -> Result<Claim, Error> {
    refuse_inputs(folder, inputs)?;
    if folder.is_file() {
        return Err(Error::OutputExists { path: folder.to_owned(), found: Occupied::NotAFolder });
    }
    // A run that holds the lock was not stopped; taking the lock fails below and names it.
    if !force && !is_in_use(folder) {
        refuse_results(folder)?;
    }
    let is_new = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
    let made = Made(folder.ancestors().take_while(is_new).map(Path::to_owned).collect());
    storage.create_folder(folder).map_err(Error::io("create", folder))?;
    for above in made.0.iter().filter_map(|folder| folder.parent()) {
        storage.sync(above).map_err(Error::io("write", folder))?;
    }
    let claim = locked(storage, folder, made)?;
    // A run that held the lock a moment ago may have left results since.
    if !force {
        refuse_results(folder)?;
    }
    Ok(claim)
}

/// Claims the folder of a run that was stopped, to resume it.
///
/// # Errors
/// [`Error::OutputIsInput`], [`Error::OutputLocked`], [`Error::Checkpoint`] where nothing was stopped, and a file that cannot be read or written for a folder that cannot be written.
pub fn claim_to_resume(folder: &Path, inputs: &[PathBuf]) -> Result<Claim, Error> {
    refuse_inputs(folder, inputs)?;
    if !folder.is_dir() {
        return Err(Error::checkpoint(folder, Problem::Missing));
    }
    locked(Arc::new(Disk), folder, Made::default())
}

fn locked(storage: Arc<dyn Storage>, folder: &Path, made: Made) -> Result<Claim, Error> {
    let (lock, stale_lock_of) = lock(folder)?;
    let is_resumable = folder.join(problem::NAME).exists();
    Ok(Claim { folder: folder.to_owned(), storage, lock: Some(lock), _made: made, stale_lock_of, is_resumable })
}

/// Whether a run writes into a folder now.
#[must_use]
pub fn is_in_use(folder: &Path) -> bool {
    let Ok(file) = File::open(folder.join(LOCK_NAME)) else { return false };
    matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock))
}

impl Claim {
    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where its files are kept.
    pub const fn storage(&self) -> &Arc<dyn Storage> {
        &self.storage
    }

    /// Path of a file or folder below it, by its name.
    ///
    /// # Errors
    /// As [`place`].
    pub fn place(&self, name: &str) -> Result<PathBuf, Error> {
        place(&self.folder, name)
    }

    /// Refuses files of others where files of these names are to be.
    ///
    /// # Errors
    /// [`Error::OutputExists`] that names the file; a name that leads out of the folder.
    pub fn refuse_others<'a>(&self, names: impl IntoIterator<Item = &'a String>) -> Result<(), Error> {
        let own = listed(&*self.storage, &self.folder)?;
        names.into_iter().try_for_each(|name| {
            place(&self.folder, name)?;
            refuse_others(&self.folder, &own, name)
        })
    }

    /// Removes a file of the folder, if it is there.
    pub fn remove(&self, name: &str) -> Result<(), Error> {
        let path = self.folder.join(name);
        self.storage.remove(&path).map_err(Error::io("remove", &path))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        if let Some(lock) = self.lock.take() {
            // Removed while it is still held; a lock file that stays is harmless.
            let _ = fs::remove_file(self.folder.join(LOCK_NAME));
            drop(lock);
        }
    }
}

/// The path without links and dots, as far as it exists.
fn resolved(path: &Path) -> PathBuf {
    let absolute = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut missing = Vec::new();
    let mut existing = absolute.as_path();
    loop {
        if let Ok(found) = fs::canonicalize(existing) {
            return missing.iter().rev().fold(found, |path, part| path.join(part));
        }
        match (existing.parent(), existing.file_name()) {
            (Some(parent), Some(name)) => {
                missing.push(name.to_owned());
                existing = parent;
            }
            _ => return absolute,
        }
    }
}

/// Refuses an output folder that is, holds or lies in an input.
///
/// # Errors
/// [`Error::OutputIsInput`].
pub fn refuse_inputs(folder: &Path, inputs: &[PathBuf]) -> Result<(), Error> {
    let out = resolved(folder);
    for input in inputs {
        let found = resolved(input);
        let is_folder = found.is_dir();
        let is_replaced = found.parent() == Some(&out)
            && found.file_name().is_some_and(|name| RESULT_NAMES.iter().any(|own| name == *own));
        if found == out || is_replaced || (is_folder && (out.starts_with(&found) || found.starts_with(&out))) {
            return Err(Error::OutputIsInput { path: folder.to_owned(), input: input.clone() });
        }
    }
    Ok(())
}

fn refuse_results(folder: &Path) -> Result<(), Error> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotADirectory => {
            return Err(Error::OutputExists { path: folder.to_owned(), found: Occupied::NotAFolder });
        }
        Err(error) => return Err(Error::io("read", folder)(error)),
    };
    let refused = |found| Err(Error::OutputExists { path: folder.to_owned(), found });
    let is_incomplete = is_incomplete(folder);
    if folder.join("summary.json").exists() && !is_incomplete {
        return refused(Occupied::Results);
    }
    if folder.join(problem::NAME).exists() {
        return refused(Occupied::StoppedRun);
    }
    if is_incomplete {
        return Ok(());
    }
    for entry in entries {
        let name = entry.map_err(Error::io("read", folder))?.file_name();
        let name = name.to_string_lossy();
        if name != LOCK_NAME && name != LIST_NAME && !name.ends_with(".partial") {
            return refused(Occupied::NotEmpty);
        }
    }
    Ok(())
}

/// Whether a summary says that what it is of was not done to the end.
#[must_use]
pub fn is_incomplete(folder: &Path) -> bool {
    let Ok(text) = fs::read_to_string(folder.join("summary.json")) else { return false };
    let summary: Option<serde_json::Value> = serde_json::from_str(&text).ok();
    summary.is_some_and(|summary| summary.get("complete") == Some(&serde_json::Value::Bool(false)))
}

fn lock(folder: &Path) -> Result<(File, Option<u32>), Error> {
    let path = place(folder, LOCK_NAME)?;
    let mut options = File::options();
    options.read(true).write(true).create(true).truncate(false);
    let mut file = options.open(&path).map_err(Error::io("write", &path))?;
    let mut found = vec![];
    // Elsewhere than on Unix a file that is locked cannot be read.
    let _ = (&file).take(32).read_to_end(&mut found);
    let before: Option<u32> = std::str::from_utf8(&found).ok().and_then(|text| text.trim().parse().ok());
    if before.is_none() && !found.is_empty() {
        return Err(Error::OutputExists { path, found: Occupied::NotOurs });
    }
    match file.try_lock() {
        Ok(()) if is_at(&file, &path) => {}
        // The run before removed the file between our opening and our locking it.
        Ok(()) => return lock(folder),
        Err(TryLockError::WouldBlock) => return Err(Error::OutputLocked { path: folder.to_owned(), pid: before }),
        // A file system without locks: the number in the file is all there is.
        Err(TryLockError::Error(_)) if before.is_none() => {}
        Err(TryLockError::Error(_)) => return Err(Error::OutputLocked { path: folder.to_owned(), pid: before }),
    }
    let write = |file: &mut File| {
        file.set_len(0)?;
        file.rewind()?;
        writeln!(file, "{}", std::process::id())?;
        file.flush()
    };
    write(&mut file).map_err(Error::io("write", &path))?;
    Ok((file, before))
}

/// Whether a file is still the one at its path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let place = |found: &fs::Metadata| (found.dev(), found.ino());
    matches!((file.metadata(), fs::metadata(path)), (Ok(held), Ok(there)) if place(&held) == place(&there))
}

/// Elsewhere a file that is open cannot be removed.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(folder: &Path, inputs: &[PathBuf], force: bool) -> String {
        let root = folder.parent().unwrap().to_string_lossy().into_owned();
        match claim(folder, inputs, force) {
            Ok(_) => "ok".into(),
            Err(error) => error.to_string().replace(&root, "."),
        }
    }

    #[test]
    fn results_are_not_overwritten() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        assert_eq!(message(&out, &[], false), "ok");
        fs::create_dir(&out).unwrap();
        assert_eq!(message(&out, &[], false), "ok");
        fs::write(out.join("markers.trc.partial"), "").unwrap();
        assert_eq!(message(&out, &[], false), "ok");
        fs::write(out.join(problem::NAME), "").unwrap();
        assert_eq!(message(&out, &[], false), "`./out` exists and holds a run that was stopped");
        assert_eq!(message(&out, &[], true), "ok");
        fs::remove_file(out.join(problem::NAME)).unwrap();
        fs::write(out.join("notes.txt"), "").unwrap();
        assert_eq!(message(&out, &[], false), "`./out` exists and is not empty");
        fs::write(out.join(problem::NAME), "").unwrap();
        assert_eq!(message(&out, &[], false), "`./out` exists and holds a run that was stopped");
        fs::write(out.join("summary.json"), r#"{"complete": false}"#).unwrap();
        assert_eq!(message(&out, &[], false), "`./out` exists and holds a run that was stopped");
        fs::remove_file(out.join(problem::NAME)).unwrap();
        assert_eq!(message(&out, &[], false), "ok");
        fs::write(out.join("summary.json"), r#"{"complete": true}"#).unwrap();
        fs::remove_file(out.join("notes.txt")).unwrap();
        assert_eq!(message(&out, &[], false), "`./out` exists and holds results");
        assert_eq!(message(&out, &[], true), "ok");
        let file = root.path().join("file");
        fs::write(&file, "").unwrap();
        assert_eq!(message(&file, &[], false), "`./file` exists and is not a folder");
    }

    #[test]
    fn folders_that_were_made_for_nothing_are_removed() {
        let root = tempfile::tempdir().unwrap();
        let (new, out) = (root.path().join("new"), root.path().join("new/run/out"));
        drop(claim(&out, &[], false).unwrap());
        assert!(!new.exists());
        let held = claim(&out, &[], false).unwrap();
        fs::write(new.join("run/notes.txt"), "").unwrap();
        drop(held);
        assert!(new.join("run").exists() && !out.exists());
        fs::create_dir(&out).unwrap();
        drop(claim(&out, &[], false).unwrap());
        assert!(out.exists());
    }

    #[test]
    fn inputs_are_safe() {
        let root = tempfile::tempdir().unwrap();
        let pose = root.path().join("trial/pose");
        fs::create_dir_all(&pose).unwrap();
        let inputs = [pose.clone()];
        for out in ["trial", "trial/pose", "trial/pose/cam1", "trial/./pose/../pose"] {
            let error = claim(&root.path().join(out), &inputs, true).err().unwrap();
            assert!(matches!(error, Error::OutputIsInput { .. }), "{out}");
        }
        assert!(claim(&root.path().join("trial/out"), &inputs, false).is_ok());
    }

    #[test]
    fn one_run_a_folder() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        let first = claim(&out, &[], false).unwrap();
        let expected = format!("`./out` is in use by another run (process {})", std::process::id());
        assert_eq!(message(&out, &[], true), expected);
        assert!(is_in_use(&out));
        drop(first);
        assert!(!is_in_use(&out));
        assert_eq!(message(&out, &[], false), "ok");
        fs::create_dir(&out).unwrap();
        fs::write(out.join(LOCK_NAME), "4000000\n").unwrap();
        assert_eq!(claim(&out, &[], false).unwrap().stale_lock_of, Some(4_000_000));
    }
}
