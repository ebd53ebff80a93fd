//! Feature vectors that are learned already, in a file beside the model that is not.
//!
//! `MODEL.unfinished` is JSON: a fingerprint of all that decides what is learned, the feature vectors, and a checksum of them. It is replaced whole after each feature vector and taken away once the model is written.

use crate::Error;
use serde::{Deserialize, Serialize};
use sinew::files::{FNV_START, fnv, read_text};
use sinew::results::write_whole;
use sinew_dynamics::primitives::check::check;
use sinew_dynamics::primitives::file::MAX_BYTES;
use sinew_dynamics::primitives::model::{FeatureVector, PrimitiveModel, Primitives};
use std::path::{Path, PathBuf};

/// The file.
pub(super) struct Unfinished {
    path: PathBuf,
}

/// What is in it.
pub(super) enum Found {
    /// There is no such file.
    Nothing,
    /// Feature vectors of this run.
    Done(Vec<Primitives>),
    /// Something else, in words.
    Foreign(String),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Content {
    fingerprint: String,
    checksum: String,
    primitives: Vec<Primitives>,
}

fn checksum(primitives: &[Primitives]) -> Result<String, Error> {
    let text = serde_json::to_string(primitives).map_err(|error| invalid(error.into()))?;
    Ok(format!("{:016x}", fnv(FNV_START, text.as_bytes())))
}

fn invalid(error: std::io::Error) -> Error {
    sinew::Error::io("encode", "unfinished feature vectors")(error).into()
}

impl Unfinished {
    /// The file beside a model.
    pub(super) fn beside(model: &Path) -> Self {
        let mut name = model.as_os_str().to_owned();
        name.push(".unfinished");
        Self { path: name.into() }
    }

    /// Writes what is done.
    pub(super) fn write(&self, fingerprint: u64, primitives: &[Primitives]) -> Result<(), Error> {
        let content = Content {
            fingerprint: format!("{fingerprint:016x}"),
            checksum: checksum(primitives)?,
            primitives: primitives.to_vec(),
        };
        let text = serde_json::to_string(&content).map_err(|error| invalid(error.into()))?;
        Ok(write_whole(&self.path, text.as_bytes())?)
    }

    /// Reads what is done of the first `features` of `model`, which has none yet.
    pub(super) fn read(&self, fingerprint: u64, model: &PrimitiveModel, features: &[FeatureVector]) -> Found {
        if !self.path.exists() {
            return Found::Nothing;
        }
        let content = read_text(&self.path, MAX_BYTES).ok().and_then(|text| serde_json::from_str(&text).ok());
        let foreign = |what: &str| Found::Foreign(format!("{} {what}; all is learned again", self.path.display()));
        let Some(Content { fingerprint: theirs, checksum: sum, primitives }) = content else {
            return foreign("is damaged");
        };
        if theirs != format!("{fingerprint:016x}") {
            return foreign("belongs to other motion or settings");
        }
        let whole = PrimitiveModel { primitives, ..model.clone() };
        let names = whole.primitives.iter().map(|primitives| &primitives.feature);
        let is_start = whole.primitives.len() <= features.len() && names.zip(features).all(|(a, b)| a == b);
        if !is_start || check(&whole).is_err() || checksum(&whole.primitives).ok() != Some(sum) {
            return foreign("is damaged");
        }
        Found::Done(whole.primitives)
    }

    /// Takes the file away.
    pub(super) fn remove(&self) -> Result<(), Error> {
        if self.path.exists() {
            std::fs::remove_file(&self.path).map_err(sinew::Error::io("remove", &self.path))?;
        }
        Ok(())
    }
}
