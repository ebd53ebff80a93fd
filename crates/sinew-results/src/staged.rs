//! Files that are made beside their places, and take them together when all are whole.
//!
//! They are written into the folder `sinew.partial` of the output folder. At the end, what an earlier run wrote and these replace is removed, and each gets its name. Until then nothing that was there is touched; where it
//! does not come to that end, `sinew.partial` is removed.

use crate::claim::Claim;
use crate::own_files::{listed, refuse_others, remove_own, write_list};
use crate::place::place;
use crate::{Error, Occupied};
use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

/// Where files lie until all are whole.
const STAGE: &str = "sinew.partial/";

/// Files on their way into a claimed folder.
pub struct Staged<'a> {
    claim: &'a Claim,
    stage: PathBuf,
    /// What earlier runs wrote.
    before: BTreeSet<String>,
    new: Mutex<BTreeSet<String>>,
}

impl Claim {
    /// A place for new files of the folder.
    ///
    /// # Errors
    /// [`Error::OutputExists`] where somebody else has a folder of that name; a folder that cannot be made.
    pub fn staged(&self) -> Result<Staged<'_>, Error> {
        let before = listed(&*self.storage, &self.folder)?;
        refuse_others(&self.folder, &before, STAGE)?;
        let stage = self.folder.join(STAGE.trim_end_matches('/'));
        self.storage.remove(&stage).map_err(Error::io("remove", &stage))?;
        let mut all = before.clone();
        all.insert(STAGE.to_owned());
        write_list(&self.storage, &self.folder, all)?;
        fs::create_dir(&stage).map_err(Error::io("create", &stage))?;
        Ok(Staged { claim: self, stage, before, new: Mutex::default() })
    }
}

impl Staged<'_> {
    /// Writes a file that will have that name in the folder.
    ///
    /// # Errors
    /// A name that leads out of the folder; [`Error::OutputExists`] where somebody else has a file of that name; errors of the disk.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Error> {
        place(&self.claim.folder, name)?;
        refuse_others(&self.claim.folder, &self.before, name)?;
        let path = place(&self.stage, name)?;
        let written = match fs::write(&path, bytes) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                let above = path.parent().unwrap_or(&self.stage);
                fs::create_dir_all(above).and_then(|()| fs::write(&path, bytes))
            }
            written => written,
        };
        written.map_err(Error::io("write", &path))?;
        self.new.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned());
        Ok(())
    }

    /// Gives all files their names; what earlier runs wrote of what `is_replaced`, and is not among them, is removed.
    ///
    /// # Errors
    /// Errors of the disk; [`Error::OutputExists`] where somebody else put a file there meanwhile.
    pub fn finish(self, is_replaced: impl Fn(&str) -> bool) -> Result<(), Error> {
        let new = std::mem::take(&mut *self.new.lock().unwrap_or_else(PoisonError::into_inner));
        let (storage, folder) = (&self.claim.storage, &self.claim.folder);
        let mut all = &self.before | &new;
        all.insert(STAGE.to_owned());
        new.iter().try_for_each(|name| refuse_others(folder, &self.before, name))?;
        write_list(storage, folder, all.clone())?;
        let old: BTreeSet<String> =
            self.before.iter().filter(|name| is_replaced(name) && !new.contains(*name)).cloned().collect();
        remove_own(&**storage, folder, old.iter())?;
        for name in &new {
            let path = place(folder, name)?;
            let above = path.parent().unwrap_or(folder);
            storage.create_folder(above).map_err(Error::io("create", above))?;
            if path.is_dir() {
                return Err(Error::OutputExists { path, found: Occupied::NotOurs });
            }
            storage.rename(&self.stage.join(name), &path).map_err(Error::io("write", &path))?;
        }
        storage.remove(&self.stage).map_err(Error::io("remove", &self.stage))?;
        all.retain(|name| name != STAGE && !old.contains(name));
        write_list(storage, folder, all)
    }
}

impl Drop for Staged<'_> {
    fn drop(&mut self) {
        // After an end there is nothing left of it.
        if self.stage.is_dir()
            && self.claim.storage.remove(&self.stage).is_ok()
            && let Ok(mut all) = listed(&*self.claim.storage, &self.claim.folder)
        {
            all.remove(STAGE);
            let _ = write_list(&self.claim.storage, &self.claim.folder, all);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claim;
    use std::path::Path;

    fn text(out: &Path, name: &str) -> String {
        fs::read_to_string(out.join(name)).unwrap_or_default()
    }

    fn filled(out: &Path, files: &[(&str, &str)]) -> Result<(), Error> {
        let claim = claim(out, &[], true)?;
        let staged = claim.staged()?;
        files.iter().try_for_each(|(name, text)| staged.write(name, text.as_bytes()))?;
        staged.finish(|name| name.starts_with("masks/"))
    }

    #[test]
    fn new_files_replace_those_of_earlier_runs_and_no_others() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        filled(&out, &[("masks/a/1", "old"), ("masks/a/2", "old"), ("other", "old")]).unwrap();
        fs::write(out.join("masks/a/mine"), "mine").unwrap();
        // Not whole: all stays as it was.
        let held = claim(&out, &[], true).unwrap();
        let staged = held.staged().unwrap();
        staged.write("masks/a/1", b"new").unwrap();
        drop(staged);
        drop(held);
        assert_eq!(["masks/a/1", "masks/a/2", "other"].map(|name| text(&out, name)), ["old"; 3]);
        filled(&out, &[("masks/a/1", "new"), ("masks/b/1", "new")]).unwrap();
        let found = ["masks/a/1", "masks/a/2", "masks/b/1", "masks/a/mine", "other"].map(|name| text(&out, name));
        assert_eq!(found, ["new", "", "new", "mine", "old"]);
        assert!(!out.join("sinew.partial").exists());
        // What is in the way is named, and stays.
        let error = filled(&out, &[("masks/a/1", "third"), ("masks/a/mine", "third")]).unwrap_err();
        assert!(error.to_string().contains("masks/a/mine"), "{error}");
        assert_eq!(["masks/a/1", "masks/a/mine"].map(|name| text(&out, name)), ["new", "mine"]);
    }

    #[test]
    fn a_folder_of_somebody_else_is_no_stage() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        fs::create_dir_all(out.join("sinew.partial")).unwrap();
        fs::write(out.join("sinew.partial/mine"), "mine").unwrap();
        let error = filled(&out, &[("masks/a", "new")]).unwrap_err();
        assert!(error.to_string().contains("sinew.partial"), "{error}");
        assert_eq!(text(&out, "sinew.partial/mine"), "mine");
    }
}
