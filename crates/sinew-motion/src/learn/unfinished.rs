//! What is learned already, in a file beside the model that is not.
//!
//! `MODEL.unfinished` is JSON: a fingerprint of all that decides what is learned, what was learned so far, and a checksum of it. It is replaced whole after each part and taken away once the model is written.

use crate::Error;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sinew_input::files::{FNV_START, fnv, read_text};
use sinew_results::write_whole;
use std::path::{Path, PathBuf};

/// Text of the file at most: a state of learning is larger than its model.
const MAX_BYTES: u64 = 1 << 30;

/// The file.
pub(super) struct Unfinished {
    path: PathBuf,
    fingerprint: String,
}

/// What is in it.
pub(super) enum Found<T> {
    /// There is no such file.
    Nothing,
    /// What this run has learned.
    Done(T),
    /// Something else, in words.
    Foreign(String),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content<T> {
    fingerprint: String,
    checksum: String,
    done: T,
}

fn checksum(done: &impl Serialize) -> Result<String, Error> {
    let text = serde_json::to_string(done).map_err(|error| invalid(error.into()))?;
    Ok(format!("{:016x}", fnv(FNV_START, text.as_bytes())))
}

fn invalid(error: std::io::Error) -> Error {
    sinew_results::Error::io("encode", "unfinished model")(error).into()
}

impl Unfinished {
    /// The file beside a model, of a run with that fingerprint.
    pub(super) fn beside(model: &Path, fingerprint: u64) -> Self {
        let mut name = model.as_os_str().to_owned();
        name.push(".unfinished");
        Self { path: name.into(), fingerprint: format!("{fingerprint:016x}") }
    }

    /// Writes what is done.
    pub(super) fn write(&self, done: &impl Serialize) -> Result<(), Error> {
        let content = Content { fingerprint: self.fingerprint.clone(), checksum: checksum(done)?, done };
        let text = serde_json::to_string(&content).map_err(|error| invalid(error.into()))?;
        Ok(write_whole(&self.path, text.as_bytes())?)
    }

    /// Reads what is done; `use_it` makes of it what can be continued, or nothing where it does not fit.
    pub(super) fn read<T: Serialize + DeserializeOwned, U>(&self, use_it: impl FnOnce(T) -> Option<U>) -> Found<U> {
        if !self.path.exists() {
            return Found::Nothing;
        }
        let foreign = |what: &str| Found::Foreign(format!("{} {what}; all is learned again", self.path.display()));
        let text = read_text(&self.path, MAX_BYTES).ok();
        let Some(content) = text.and_then(|text| serde_json::from_str::<Content<T>>(&text).ok()) else {
            return foreign("is damaged");
        };
        if content.fingerprint != self.fingerprint {
            return foreign("belongs to other motion or settings");
        }
        if checksum(&content.done).ok() != Some(content.checksum) {
            return foreign("is damaged");
        }
        use_it(content.done).map_or_else(|| foreign("is damaged"), Found::Done)
    }

    /// Takes the file away.
    pub(super) fn remove(&self) -> Result<(), Error> {
        if self.path.exists() {
            std::fs::remove_file(&self.path).map_err(sinew_results::Error::io("remove", &self.path))?;
        }
        Ok(())
    }
}
