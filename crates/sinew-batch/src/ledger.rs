//! How the tasks of a study ended: one line of JSON each, written after the results of the task are on the disk.
//!
//! Each shard writes a file of its own; a last line that is incomplete, because the process was killed, is dropped. Shards of one division may be run at once, and no others beside them: they would run trials twice.

use crate::Error;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use sinew::files::read_bytes;
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew_results::place;
use std::collections::HashMap;
use std::fs::{self, File, TryLockError};
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use super::shard::Shard;

/// Folder of result folders and archives in a study.
pub(super) const RESULTS: &str = "results";

/// Folder of the ledgers in a study.
const LEDGERS: &str = "ended";

/// Folder of the results of the trial that is the root itself: no trial has this name, and the results of all others lie beside it.
const OF_ROOT: &str = "sinew-out";

/// Longest ledger that is read, bytes: some million lines.
const MAX_BYTES: u64 = 1 << 30;

/// How a task ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TaskEnd {
    /// Results were written, and all diagnostics passed.
    Done,
    /// Results were written, and at least one diagnostic failed.
    Doubtful,
    /// No results were written.
    Failed,
}

/// Where the results of a task lie in an archive.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Packed {
    /// Name of the archive in the study.
    pub archive: String,
    /// Offset of the first byte of the results.
    pub offset: u64,
    /// Number of bytes.
    pub length: u64,
}

/// A line of a ledger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EndedTask {
    /// Name of the trial.
    pub trial: String,
    /// Hash of its inputs and settings.
    pub hash: String,
    /// How it ended.
    pub ended: TaskEnd,
    /// Exit code that `sinew track` would have had.
    pub code: u8,
    /// Why, where it failed or is doubtful.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub why: String,
    /// Seconds it took in all, set-up and tracking included.
    pub seconds: f64,
    /// Seconds of set-up and tracking.
    pub computing_s: f64,
    /// Which run of the study it ended in: each that begins has a number above those before.
    #[serde(default)]
    pub run: u64,
    /// When it ended, seconds since 1970.
    pub at_unix_s: f64,
    /// Where its results are, if they are not in a folder of their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub packed: Option<Packed>,
}

/// The ledger of a shard, which this process alone may write.
pub struct Ledger {
    file: File,
    path: PathBuf,
}

impl Ledger {
    /// Opens the ledger of a shard to append to it; an incomplete last line is removed.
    ///
    /// # Errors
    /// [`Error::ShardInUse`] for this shard, or for one of another division; errors of the disk.
    pub fn open(study: &Path, shard: Shard) -> Result<Self, Error> {
        let folder = study.join(LEDGERS);
        fs::create_dir_all(&folder).map_err(sinew::Error::io("create", &folder))?;
        let path = place(&folder, format!("{}-of-{}.jsonl", shard.index, shard.count))?;
        let failed = |error| sinew::Error::io("write", &path)(error);
        let mut file = File::options().read(true).append(true).create(true).open(&path).map_err(failed)?;
        let in_use = |shard: Shard| Error::ShardInUse { shard: shard.to_string(), study: study.into() };
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(in_use(shard)),
            Err(TryLockError::Error(error)) => return Err(failed(error).into()),
        }
        // The own lock is held by now: of two that begin at once, at least one sees the other.
        for (other, path) in ledgers(&folder)? {
            let Some(other) = other.filter(|other| other.count != shard.count) else { continue };
            let is_held = |file: File| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock));
            if File::open(path).is_ok_and(is_held) {
                return Err(in_use(other));
            }
        }
        let bytes = read_bytes(&path, MAX_BYTES).map_err(sinew::Error::from)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
        file.set_len(whole as u64).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failed)?;
        Ok(Self { file, path })
    }

    /// Adds lines, and waits until they are on the disk.
    ///
    /// # Errors
    /// Errors of the disk.
    pub fn add<'a>(&mut self, tasks: impl Iterator<Item = &'a EndedTask>) -> Result<(), Error> {
        let lines: String = tasks.map(|task| serde_json::to_string(task).unwrap_or_default() + "\n").collect();
        let written = self.file.write_all(lines.as_bytes()).and_then(|()| self.file.sync_data());
        Ok(written.map_err(sinew::Error::io("write", &self.path))?)
    }
}

/// The latest line of each trial of a study, by the name of the trial: the one with the highest [`EndedTask::run`], and within that run the last one read.
///
/// # Errors
/// A ledger that cannot be read.
pub fn ended(study: &Path) -> Result<HashMap<String, EndedTask>, Error> {
    let mut all: HashMap<String, EndedTask> = HashMap::new();
    for (_, path) in ledgers(&study.join(LEDGERS))? {
        // Bytes, since a line that was cut may end inside a letter.
        let bytes = read_bytes(&path, MAX_BYTES).map_err(sinew::Error::from)?;
        let lines = bytes.split(|byte| *byte == b'\n');
        for task in lines.filter_map(|line| serde_json::from_slice::<EndedTask>(line).ok()) {
            if all.get(&task.trial).is_none_or(|known| known.run <= task.run) {
                all.insert(task.trial.clone(), task);
            }
        }
    }
    Ok(all)
}

/// The ledgers in a folder, by name, with their shards where the names are those of shards.
fn ledgers(folder: &Path) -> Result<Vec<(Option<Shard>, PathBuf)>, Error> {
    let mut files: Vec<PathBuf> = match fs::read_dir(folder) {
        Ok(entries) => entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>(),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(vec![]),
        Err(error) => Err(error),
    }
    .map_err(sinew::Error::io("read", folder))?;
    files.retain(|path| path.extension().is_some_and(|e| e == "jsonl"));
    files.sort();
    let shard = |path: &Path| path.file_stem()?.to_str()?.replace("-of-", "/").parse().ok();
    Ok(files.into_iter().map(|path| (shard(&path), path)).collect())
}

/// Name of the results of a trial among those of a study.
pub(super) fn results_name(trial: &str) -> &str {
    if trial == "." { OF_ROOT } else { trial }
}

/// Folder of the results of a trial in a study.
pub(super) fn results_folder(study: &Path, trial: &str) -> PathBuf {
    study.join(RESULTS).join(results_name(trial))
}

/// Whether the summary of results is a whole document: a disk that was full or a copy that was stopped leaves the beginning, or nothing.
fn is_whole(summary: &Path) -> bool {
    let bytes = read_bytes(summary, MAX_TEXT_BYTES).unwrap_or_default();
    std::str::from_utf8(&bytes).is_ok_and(|text| serde_json::from_str::<IgnoredAny>(text).is_ok())
}

impl EndedTask {
    /// Whether there are results.
    #[must_use]
    pub fn is_there(&self) -> bool {
        self.ended != TaskEnd::Failed
    }

    /// Whether the results of which it speaks are still in a study.
    #[must_use]
    pub fn is_kept(&self, study: &Path) -> bool {
        match &self.packed {
            Some(Packed { archive, offset, length }) => {
                fs::metadata(study.join(archive)).is_ok_and(|file| offset + length <= file.len())
            }
            None => {
                let folder = results_folder(study, &self.trial);
                let people = fs::read_dir(folder.join("people")).into_iter().flatten().flatten();
                let mut of_people =
                    people.map(|person| person.path().join("summary.json")).filter(|path| path.exists());
                is_whole(&folder.join("summary.json")) && of_people.all(|summary| is_whole(&summary))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of a run that ended `at_unix_s`, by a clock that may be wrong.
    fn task(trial: &str, hash: &str, ended: TaskEnd, (run, at_unix_s): (u64, f64)) -> EndedTask {
        let (trial, hash) = (trial.to_owned(), hash.to_owned());
        let (seconds, computing_s, why, packed) = (1.0, 0.5, String::new(), None);
        EndedTask { trial, hash, ended, code: 0, why, seconds, computing_s, run, at_unix_s, packed }
    }

    fn add(ledger: &mut Ledger, lines: &[EndedTask]) {
        ledger.add(lines.iter()).unwrap();
    }

    #[test]
    fn the_latest_line_counts_and_a_cut_line_does_not() {
        let study = tempfile::tempdir().unwrap();
        let shard = |index| Shard { index, count: 2 };
        let mut second = Ledger::open(study.path(), shard(1)).unwrap();
        add(&mut second, &[task("a", "old", TaskEnd::Done, (1, 9.0))]);
        drop(second);
        let mut first = Ledger::open(study.path(), shard(0)).unwrap();
        add(&mut first, &[task("a", "new", TaskEnd::Failed, (2, 3.0)), task("b", "x", TaskEnd::Doubtful, (2, 2.0))]);
        let path = study.path().join("ended/1-of-2.jsonl");
        let mut cut = fs::read(&path).unwrap();
        cut.extend_from_slice(b"{\"trial\":\"b\xc3");
        fs::write(&path, &cut).unwrap();
        let all = ended(study.path()).unwrap();
        assert_eq!((all["a"].hash.as_str(), all["a"].ended), ("new", TaskEnd::Failed));
        assert_eq!(all["b"].ended, TaskEnd::Doubtful);
        add(&mut Ledger::open(study.path(), shard(1)).unwrap(), &[task("b", "x", TaskEnd::Done, (3, 1.0))]);
        assert_eq!(ended(study.path()).unwrap()["b"].ended, TaskEnd::Done);
    }

    #[test]
    fn a_shard_is_run_by_one_process() {
        let study = tempfile::tempdir().unwrap();
        let _first = Ledger::open(study.path(), Shard::WHOLE).unwrap();
        let second = Ledger::open(study.path(), Shard::WHOLE).err().unwrap();
        assert!(matches!(second, Error::ShardInUse { .. }), "{second}");
    }

    #[test]
    fn a_whole_run_and_a_shard_are_not_run_at_once() {
        let study = tempfile::tempdir().unwrap();
        let shards = [0, 1].map(|index| Shard { index, count: 2 });
        let refused = |shard| Ledger::open(study.path(), shard).err().map(|error| error.to_string());
        let [first, second] = shards.map(|shard| Ledger::open(study.path(), shard).unwrap());
        assert!(refused(Shard::WHOLE).unwrap().starts_with("shard 0/2 of"));
        drop(first);
        assert!(refused(Shard::WHOLE).unwrap().starts_with("shard 1/2 of"));
        drop(second);
        let _whole = Ledger::open(study.path(), Shard::WHOLE).unwrap();
        assert!(shards.iter().all(|shard| refused(*shard).unwrap().starts_with("shard 0/1 of")));
    }

    #[test]
    fn results_with_half_a_summary_are_not_kept() {
        let study = tempfile::tempdir().unwrap();
        let done = |trial| task(trial, "x", TaskEnd::Done, (1, 0.0));
        for (trial, folder) in [("S1/walk", "results/S1/walk"), (".", "results/sinew-out")] {
            let summary = study.path().join(folder).join("summary.json");
            fs::create_dir_all(summary.parent().unwrap()).unwrap();
            let texts: [(&[u8], bool); 4] =
                [(b"{\"a\":\"b\"}\n", true), (b"{\"a\":\"b", false), (b"", false), (b"{\"a\":\"\xc3\"}", false)];
            for (text, is_kept) in texts {
                fs::write(&summary, text).unwrap();
                assert_eq!(done(trial).is_kept(study.path()), is_kept, "{text:?}");
            }
        }
    }
}
