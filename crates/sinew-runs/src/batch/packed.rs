//! Results of many trials in one archive a shard: one file in place of a hundred a trial.
//!
//! The archive is a tar file that holds the files of the trials one after the other; the ledger says where each begins. What a kill left behind the last whole trial is cut off.

use super::ledger::{EndedTask, Packed, ended};
use super::shard::Shard;
use crate::Error;
use std::fs::{self, File};
use std::io::{Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folder of the archives in a study.
const ARCHIVES: &str = "results";

/// Two empty blocks, with which a tar file ends.
const END: [u8; 1024] = [0; 1024];

/// The archive of a shard.
pub(super) struct Archive {
    name: String,
    path: PathBuf,
    file: Mutex<File>,
}

impl Archive {
    /// Opens the archive of a shard behind the last trial that a ledger knows.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn open<'a>(
        study: &Path,
        shard: Shard,
        known: impl Iterator<Item = &'a EndedTask>,
    ) -> Result<Self, Error> {
        let name = format!("{ARCHIVES}/{}-of-{}.tar", shard.index, shard.count);
        let path = study.join(&name);
        let folder = study.join(ARCHIVES);
        fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
        let failed = |error| sinew::Error::io("write", &path)(error);
        let file = File::options().read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        let own = known.filter_map(|task| task.packed.as_ref()).filter(|packed| packed.archive == name);
        let end = own.map(|packed| packed.offset + packed.length).max().unwrap_or(0);
        file.set_len(end).map_err(failed)?;
        Ok(Self { name, path, file: Mutex::new(file) })
    }

    /// Appends a folder under the name of its trial, and waits until it is on the disk.
    ///
    /// # Errors
    /// Errors of the disk; the archive is then as it was.
    pub(super) fn append(&self, trial: &str, folder: &Path) -> Result<Packed, Error> {
        let failed = |error| sinew::Error::io("write", &self.path)(error);
        let mut bytes = tar::Builder::new(vec![]);
        bytes.mode(tar::HeaderMode::Deterministic);
        for path in files_below(folder)? {
            let inside = path.strip_prefix(folder).unwrap_or(&path);
            bytes
                .append_path_with_name(&path, Path::new(trial).join(inside))
                .map_err(sinew::Error::io("read", &path))?;
        }
        let mut bytes = bytes.into_inner().map_err(failed)?;
        bytes.truncate(bytes.len() - END.len());
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let offset = file.metadata().map_err(failed)?.len();
        let written =
            file.seek(SeekFrom::Start(offset)).and_then(|_| file.write_all(&bytes)).and_then(|()| file.sync_data());
        if let Err(error) = written {
            // What was written of it would stand before the next trial.
            file.set_len(offset).map_err(failed)?;
            return Err(failed(error).into());
        }
        Ok(Packed { archive: self.name.clone(), offset, length: bytes.len() as u64 })
    }
}

/// Files below a folder, by name.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let failed = |error| sinew::Error::io("read", folder)(error);
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).and_then(|entries| entries.map(|e| Ok(e?.path())).collect()).map_err(failed)?;
    entries.sort();
    let mut files = vec![];
    for entry in entries {
        if entry.is_dir() { files.extend(files_below(&entry)?) } else { files.push(entry) }
    }
    Ok(files)
}

/// Takes the results of a trial out of its archive: the files that are wanted, with what they hold.
///
/// # Errors
/// Errors of the disk; an archive that is cut short.
pub fn unpacked(
    study: &Path,
    packed: &Packed,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let path = study.join(&packed.archive);
    let failed = |error| sinew::Error::io("read", &path)(error);
    let mut file = File::open(&path).map_err(failed)?;
    file.seek(SeekFrom::Start(packed.offset)).map_err(failed)?;
    let mut archive = tar::Archive::new(file.take(packed.length));
    let mut found = vec![];
    for entry in archive.entries().map_err(failed)? {
        let mut entry = entry.map_err(failed)?;
        let name = entry.path().map_err(failed)?.to_string_lossy().into_owned();
        if is_wanted(&name) {
            let mut bytes = vec![];
            entry.read_to_end(&mut bytes).map_err(failed)?;
            found.push((name, bytes));
        }
    }
    Ok(found)
}

/// Takes all results of a trial out of a study into a folder.
///
/// # Errors
/// [`Error::NotPacked`]; errors of the disk.
pub fn unpack(study: &Path, trial: &str, out: &Path) -> Result<(), Error> {
    let known = ended(study)?;
    let packed = known.get(trial).and_then(|line| line.packed.as_ref());
    let packed = packed.ok_or_else(|| Error::NotPacked { study: study.to_owned(), trial: trial.to_owned() })?;
    for (name, bytes) in unpacked(study, packed, |_| true)? {
        let Ok(inside) = Path::new(&name).strip_prefix(trial) else { continue };
        let path = out.join(inside);
        let folder = path.parent().unwrap_or(out);
        fs::create_dir_all(folder).map_err(sinew::Error::io("create", folder))?;
        fs::write(&path, bytes).map_err(sinew::Error::io("write", &path))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::ledger::TaskEnd;
    use super::*;

    fn line(packed: Packed) -> EndedTask {
        EndedTask {
            trial: "t".into(),
            hash: String::new(),
            ended: TaskEnd::Done,
            code: 0,
            why: String::new(),
            seconds: 0.0,
            computing_s: 0.0,
            at_unix_s: 0.0,
            packed: Some(packed),
        }
    }

    #[test]
    fn packed_files_come_out_also_after_a_kill() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("scratch");
        fs::create_dir_all(folder.join("b/c")).unwrap();
        fs::write(folder.join("a.csv"), "first").unwrap();
        fs::write(folder.join("b/c/0"), [7; 1000]).unwrap();
        let study = root.path().join("study");
        let archive = Archive::open(&study, Shard::WHOLE, std::iter::empty()).unwrap();
        let first = line(archive.append("S1/walk", &folder).unwrap());
        archive.append("S1/lost", &folder).unwrap();
        drop(archive);
        fs::write(folder.join("a.csv"), "second").unwrap();
        let archive = Archive::open(&study, Shard::WHOLE, std::iter::once(&first)).unwrap();
        let second = archive.append("S1/run", &folder).unwrap();
        let first = first.packed.unwrap();
        assert_eq!(second.offset, first.length);
        let text = |packed: &Packed, name: &str| unpacked(&study, packed, |file| file == name).unwrap();
        assert_eq!(text(&first, "S1/walk/a.csv"), [("S1/walk/a.csv".to_owned(), b"first".to_vec())]);
        assert_eq!(text(&second, "S1/run/a.csv")[0].1, b"second");
        assert_eq!(unpacked(&study, &second, |_| true).unwrap().len(), 2);
        // Any program that knows tar files reads the whole.
        let whole = fs::File::open(study.join(&first.archive)).unwrap();
        assert_eq!(tar::Archive::new(whole).entries().unwrap().filter(Result::is_ok).count(), 4);
    }
}
