//! `sinew.files`: the files of an output folder that we wrote. Only these are ever removed or replaced.
//!
//! 1. What a run writes under provisional names is listed before the first of them is there, a folder with all in it as `NAME/`.
//! 2. Files are listed under their final names before they get them, so that a kill leaves nothing of ours unlisted.
//! 3. When the new results are whole, what an earlier run wrote in their place is removed from the disk and the list.
//!
//! A file that is not listed is somebody else's: it stays, and where it is in the way it is refused by name ([`refuse_others`]).

use crate::partial::write_whole_in;
use crate::place::place;
use crate::storage::{Disk, Storage, files_below};
use crate::{Error, Occupied};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Name of the lock file, which is listed nowhere.
pub const LOCK_NAME: &str = "sinew.lock";

/// Name of the list.
pub const LIST_NAME: &str = "sinew.files";

/// Bytes of a list at most: some million names.
const MAX_BYTES: u64 = 1 << 28;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    /// Files that sinew wrote into this folder, and may replace.
    sinew_wrote: BTreeSet<String>,
}

/// Names of the files that we wrote into a folder; none where it has no list.
///
/// # Errors
/// A list that cannot be read; [`Error::OutputExists`] for a file of that name that is none.
pub(crate) fn listed(storage: &dyn Storage, folder: &Path) -> Result<BTreeSet<String>, Error> {
    let path = folder.join(LIST_NAME);
    let mut bytes = vec![];
    match storage.read(&path).and_then(|file| file.take(MAX_BYTES).read_to_end(&mut bytes)) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(BTreeSet::new()),
        read => read.map_err(Error::io("read", &path))?,
    };
    match serde_json::from_slice::<List>(&bytes) {
        Ok(list) => Ok(list.sinew_wrote),
        Err(_) => Err(Error::OutputExists { path, found: Occupied::NotOurs }),
    }
}

/// Writes the list of a folder, whole; takes it away where nothing is left to list.
pub(crate) fn write_list(storage: &Arc<dyn Storage>, folder: &Path, names: BTreeSet<String>) -> Result<(), Error> {
    let path = place(folder, LIST_NAME)?;
    if names.is_empty() {
        return storage.remove(&path).map_err(Error::io("remove", &path));
    }
    let text = serde_json::to_string_pretty(&List { sinew_wrote: names }).unwrap_or_default() + "\n";
    write_whole_in(storage, &path, text.as_bytes())
}

/// Whether a file of a folder was written by us.
#[must_use]
pub fn is_own(folder: &Path, name: &str) -> bool {
    listed(&Disk, folder).is_ok_and(|own| own.contains(name))
}

/// Adds files to the list of a folder.
///
/// # Errors
/// A list that cannot be written.
pub fn add_own(storage: &Arc<dyn Storage>, folder: &Path, names: &[&str]) -> Result<(), Error> {
    let before = listed(&**storage, folder)?;
    let mut all = before.clone();
    all.extend(names.iter().map(|name| (*name).to_owned()));
    if all == before { Ok(()) } else { write_list(storage, folder, all) }
}

/// Adds what was made of results to the list of their folder, if it has one.
///
/// # Errors
/// A list that cannot be written.
pub fn list_derived(results: &Path, names: &[&str]) -> Result<(), Error> {
    match results.join(LIST_NAME).exists() {
        true => add_own(&(Arc::new(Disk) as Arc<dyn Storage>), results, names),
        false => Ok(()),
    }
}

/// Path of a file that we write into a folder from now on, and list.
///
/// # Errors
/// [`Error::OutputExists`] where somebody else has a file of that name; a name that leads out of the folder; a list that cannot be written.
pub fn own_place(storage: &Arc<dyn Storage>, folder: &Path, name: &str) -> Result<PathBuf, Error> {
    let path = place(folder, name)?;
    refuse_others(folder, &listed(&**storage, folder)?, name)?;
    add_own(storage, folder, &[name])?;
    Ok(path)
}

/// Refuses to replace what is there and is not `own`; a name that ends with `/` is a folder with all in it.
///
/// # Errors
/// [`Error::OutputExists`] that names what is in the way; links below the folder.
pub(crate) fn refuse_others(folder: &Path, own: &BTreeSet<String>, name: &str) -> Result<(), Error> {
    if own.contains(name) {
        return Ok(());
    }
    let path = folder.join(name.trim_end_matches('/'));
    let Ok(found) = fs::symlink_metadata(&path) else { return Ok(()) };
    let other = match found.is_dir() && name.ends_with('/') {
        true => files_below(&path)
            .map_err(Error::io("read", &path))?
            .into_iter()
            .find(|file| !own.contains(&slashed(folder, file))),
        false => Some(path),
    };
    match other {
        Some(path) => Err(Error::OutputExists { path, found: Occupied::NotOurs }),
        None => Ok(()),
    }
}

/// Removes files that we wrote, and folders in which nothing is left.
///
/// # Errors
/// A name that leads out of the folder; a file that cannot be removed.
pub(crate) fn remove_own<'a>(
    storage: &dyn Storage,
    folder: &Path,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), Error> {
    for name in names {
        // What is a link now is removed, not followed; a link on the way is refused.
        let (above, last) = name.trim_end_matches('/').rsplit_once('/').unwrap_or((".", name.trim_end_matches('/')));
        let above = place(folder, above)?;
        if matches!(last, "" | "." | "..") {
            return Err(Error::OutputOutside { folder: folder.to_owned(), name: name.into() });
        }
        let path = above.join(last);
        let is_folder = fs::symlink_metadata(&path).is_ok_and(|found| found.is_dir());
        if !is_folder || name.ends_with('/') {
            storage.remove(&path).map_err(Error::io("remove", &path))?;
        }
        let emptied = above.ancestors().take_while(|above| *above != folder && above.starts_with(folder));
        // The first that is not empty keeps all above it.
        let _ = emptied.map(fs::remove_dir).try_for_each(|removed| removed);
    }
    Ok(())
}

/// Removes all that runs of ours left in a folder, and the folder where nothing else is in it.
///
/// # Errors
/// A file that cannot be removed.
pub fn remove_results(folder: &Path) -> Result<(), Error> {
    let storage: Arc<dyn Storage> = Arc::new(Disk);
    remove_own(&*storage, folder, listed(&*storage, folder)?.iter())?;
    write_list(&storage, folder, BTreeSet::new())?;
    if fs::read_dir(folder).is_ok_and(|mut left| left.all(|entry| entry.is_ok_and(|it| it.file_name() == LOCK_NAME))) {
        Disk.remove(folder).map_err(Error::io("remove", folder))?;
    }
    Ok(())
}

/// The name of a path in the list of a folder.
pub(crate) fn slashed(folder: &Path, path: &Path) -> String {
    let parts: Vec<_> = path.strip_prefix(folder).unwrap_or(path).iter().map(|part| part.to_string_lossy()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn put(folder: &Path, name: &str) {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, name).unwrap();
    }

    #[test]
    fn only_what_is_listed_is_removed() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        for name in ["a.csv", "store/c/0", "store/c/1", "store/mine", "gone/x", "whole/y/z", "mine.csv"] {
            put(&out, name);
        }
        let storage: Arc<dyn Storage> = Arc::new(Disk);
        add_own(&storage, &out, &["a.csv", "store/c/0", "store/c/1", "gone/x", "whole/", "never/was"]).unwrap();
        remove_results(&out).unwrap();
        let mut left: Vec<String> = files_below(&out).unwrap().iter().map(|file| slashed(&out, file)).collect();
        left.sort();
        assert_eq!(left, ["mine.csv", "store/mine"]);
        assert!(!out.join("gone").exists() && !out.join("whole").exists());
        fs::remove_file(out.join("mine.csv")).unwrap();
        fs::remove_dir_all(out.join("store")).unwrap();
        remove_results(&out).unwrap();
        assert!(!out.exists());
    }

    /// A list that was edited removes nothing outside.
    #[test]
    fn a_list_does_not_lead_out_of_its_folder() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        put(&out, "a.csv");
        put(root.path(), "beside/mine");
        let storage: Arc<dyn Storage> = Arc::new(Disk);
        for name in ["../beside/mine", "../beside/", "a/../../beside/mine"] {
            write_list(&storage, &out, BTreeSet::from([name.to_owned()])).unwrap();
            let error = remove_results(&out).unwrap_err();
            assert!(matches!(error, Error::OutputOutside { .. }), "{error}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(root.path().join("beside"), out.join("link")).unwrap();
            write_list(&storage, &out, BTreeSet::from(["link/mine".to_owned()])).unwrap();
            assert!(matches!(remove_results(&out).unwrap_err(), Error::OutputLink(_)));
            // The link itself goes, and what it leads to stays.
            write_list(&storage, &out, BTreeSet::from(["link/".to_owned()])).unwrap();
            remove_results(&out).unwrap();
            assert!(!out.join("link").is_symlink());
        }
        assert!(root.path().join("beside/mine").exists());
    }
}
