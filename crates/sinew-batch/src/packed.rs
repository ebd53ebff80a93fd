//! Results of many trials in one archive a shard: one file in place of a hundred a trial.
//!
//! The archive is a tar file that holds the files of the trials one after the other; the ledger says where each begins. What a kill left behind the last whole trial is cut off.

use super::ledger::{EndedTask, Packed, ended};
use super::plan::read;
use super::scratch::Scratch;
use super::shard::Shard;
use crate::Error;
use sinew_results::{LIST_NAME, claim, place};
use std::fs::{self, File};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// Folder of the archives in a study.
const ARCHIVES: &str = "results";

/// Length of the blocks of a tar file.
const BLOCK_BYTES: u64 = 512;

/// Two empty blocks, with which a tar file ends.
const END_BYTES: u64 = 1024;

/// When every packed file was changed, whatever the clock says: 2026. Some programs take 0 for no time.
const MODIFIED_UNIX_S: u64 = 1_767_225_600;

/// Bytes that are written at once.
const BUFFER: usize = 1 << 18;

/// The archive of a shard.
pub(super) struct Archive {
    name: String,
    path: PathBuf,
    file: File,
}

impl Archive {
    /// Opens the archive of a shard behind the last of the trials whose results are in it.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn open<'a>(
        study: &Path,
        shard: Shard,
        kept: impl Iterator<Item = &'a EndedTask>,
    ) -> Result<Self, Error> {
        let name = format!("{ARCHIVES}/{}-of-{}.tar", shard.index, shard.count);
        let folder = study.join(ARCHIVES);
        fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
        let path = place(&folder, format!("{}-of-{}.tar", shard.index, shard.count))?;
        let failed = |error| sinew::Error::io("write", &path)(error);
        let file = File::options().read(true).write(true).create(true).truncate(false).open(&path).map_err(failed)?;
        let own = kept.filter_map(|task| task.packed.as_ref()).filter(|packed| packed.archive == name);
        let end = own.map(|packed| packed.offset + packed.length).max().unwrap_or(0);
        file.set_len(end).map_err(failed)?;
        Ok(Self { name, path, file })
    }

    /// Appends results under the name of their trial.
    ///
    /// # Errors
    /// Errors of the disk; the archive is then as it was.
    pub(super) fn append(&mut self, trial: &str, results: &Scratch) -> Result<Packed, Error> {
        let path = self.path.clone();
        let failed = |error| sinew::Error::io("write", &path)(error);
        let offset = self.file.seek(SeekFrom::End(0)).map_err(failed)?;
        match self.write(trial, results) {
            Ok(end) => Ok(Packed { archive: self.name.clone(), offset, length: end - offset }),
            Err(error) => {
                // What was written of it would stand before the next trial.
                self.file.set_len(offset).map_err(failed)?;
                Err(error)
            }
        }
    }

    /// Writes results behind what is there; gives the place of their end.
    fn write(&mut self, trial: &str, results: &Scratch) -> Result<u64, Error> {
        let failed = |error| sinew::Error::io("write", &self.path)(error);
        let mut out = tar::Builder::new(BufWriter::with_capacity(BUFFER, &mut self.file));
        for path in results.files()? {
            let inside = path.strip_prefix(results.folder()).unwrap_or(&path);
            let (length, content) = results.open(&path).map_err(sinew::Error::io("read", &path))?;
            let mut header = tar::Header::new_gnu();
            header.set_size(length);
            header.set_mode(0o644);
            header.set_mtime(MODIFIED_UNIX_S);
            out.append_data(&mut header, Path::new(trial).join(inside), content).map_err(failed)?;
        }
        let end = out.into_inner().and_then(|mut out| out.flush()).and_then(|()| self.file.stream_position());
        let end = end.map_err(failed)? - END_BYTES;
        self.file.set_len(end).map_err(failed)?;
        Ok(end)
    }

    /// Waits until all that was appended is on the disk.
    ///
    /// # Errors
    /// Errors of the disk.
    pub(super) fn sync(&self) -> Result<(), Error> {
        Ok(self.file.sync_data().map_err(sinew::Error::io("write", &self.path))?)
    }
}

/// A file from a place on.
struct FromPlace {
    file: File,
    start: u64,
}

impl Read for FromPlace {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.file.read(bytes)
    }
}

impl Seek for FromPlace {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let to = if let SeekFrom::Start(place) = to { SeekFrom::Start(self.start + place) } else { to };
        Ok(self.file.seek(to)?.saturating_sub(self.start))
    }
}

/// Takes the results of a trial out of its archive: the files that are wanted, with what they hold.
///
/// # Errors
/// Errors of the disk; an archive that is cut short or holds something else there.
pub fn unpacked(
    study: &Path,
    packed: &Packed,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<Vec<(String, Vec<u8>)>, Error> {
    let path = study.join(&packed.archive);
    let failed = |error| sinew::Error::io("read", &path)(error);
    let mut file = File::open(&path).map_err(failed)?;
    file.seek(SeekFrom::Start(packed.offset)).map_err(failed)?;
    let mut archive = tar::Archive::new(FromPlace { file, start: packed.offset });
    let (mut found, mut end) = (vec![], 0);
    // Files that are not wanted are passed over, not read.
    for entry in archive.entries_with_seek().map_err(failed)? {
        let mut entry = entry.map_err(failed)?;
        if entry.raw_header_position() >= packed.length {
            break;
        }
        end = (entry.raw_file_position() + entry.size()).next_multiple_of(BLOCK_BYTES);
        let name = entry.path().map_err(failed)?.to_string_lossy().into_owned();
        if is_wanted(&name) {
            let mut bytes = vec![];
            entry.read_to_end(&mut bytes).map_err(failed)?;
            found.push((name, bytes));
        }
    }
    if end == packed.length {
        return Ok(found);
    }
    let damaged = format!("{end} of {} bytes from {} on are files of this trial", packed.length, packed.offset);
    Err(failed(io::Error::new(io::ErrorKind::InvalidData, damaged)).into())
}

/// Name of a file in a trial's results, from its name in the archive; the trial `.` is the root of the study.
pub(super) fn inside<'a>(trial: &str, name: &'a str) -> &'a str {
    let folder = if trial == "." { "./" } else { trial };
    name.strip_prefix(folder).map_or(name, |name| name.trim_start_matches('/'))
}

/// Takes all results of a trial out of a study into a folder, which may hold results only if `force` says so.
///
/// # Errors
/// [`Error::NotAStudy`], [`Error::NotPacked`]; a folder that cannot be claimed; an archive with names that lead out of the folder; files of others in the way; errors of the disk.
pub fn unpack(study: &Path, trial: &str, out: &Path, force: bool) -> Result<(), Error> {
    read(study)?;
    let known = ended(study)?;
    let packed = known.get(trial).and_then(|line| line.packed.as_ref());
    let packed = packed.ok_or_else(|| Error::NotPacked { study: study.to_owned(), trial: trial.to_owned() })?;
    let files = unpacked(study, packed, |_| true)?;
    let claim = claim(out, &[], force)?;
    let staged = claim.staged()?;
    for (name, bytes) in &files {
        let name = inside(trial, name);
        // The folder has a list of its own.
        if name != LIST_NAME {
            staged.write(name, bytes)?;
        }
    }
    Ok(staged.finish(|_| true)?)
}

#[cfg(test)]
mod tests {
    use super::super::ledger::TaskEnd;
    use super::*;
    use sinew_results::Storage as _;

    fn line(packed: Packed) -> EndedTask {
        EndedTask {
            trial: "t".into(),
            hash: String::new(),
            ended: TaskEnd::Done,
            code: 0,
            why: String::new(),
            seconds: 0.0,
            computing_s: 0.0,
            run: 1,
            at_unix_s: 0.0,
            packed: Some(packed),
        }
    }

    #[test]
    fn packed_files_come_out_also_after_a_kill() {
        let root = tempfile::tempdir().unwrap();
        let results = Scratch::new().unwrap();
        let write = |name: &str, bytes: &[u8]| {
            let mut file = results.storage().create(&results.folder().join(name)).unwrap();
            file.write_all(bytes).unwrap();
        };
        write("a.csv", b"first");
        write("b/c/0", &[7; 1000]);
        fs::write(results.folder().join("disk.csv"), "on the disk").unwrap();
        let study = root.path().join("study");
        let mut archive = Archive::open(&study, Shard::WHOLE, std::iter::empty()).unwrap();
        let first = line(archive.append("S1/walk", &results).unwrap());
        archive.append("S1/lost", &results).unwrap();
        drop(archive);
        write("a.csv", b"second");
        let mut archive = Archive::open(&study, Shard::WHOLE, std::iter::once(&first)).unwrap();
        let second = archive.append("S1/run", &results).unwrap();
        let first = first.packed.unwrap();
        assert_eq!(second.offset, first.length);
        let text = |packed: &Packed, name: &str| unpacked(&study, packed, |file| file == name).unwrap();
        assert_eq!(text(&first, "S1/walk/a.csv"), [("S1/walk/a.csv".to_owned(), b"first".to_vec())]);
        assert_eq!(text(&second, "S1/run/a.csv")[0].1, b"second");
        assert_eq!(text(&second, "S1/run/disk.csv")[0].1, b"on the disk");
        assert_eq!(unpacked(&study, &second, |_| true).unwrap().len(), 3);
        // Any program that knows tar files reads the whole.
        let whole = fs::File::open(study.join(&first.archive)).unwrap();
        assert_eq!(tar::Archive::new(whole).entries().unwrap().filter(Result::is_ok).count(), 6);
    }
}
