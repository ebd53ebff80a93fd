//! The file of a latent model: JSON with a name of the format and a version.
//!
//! ```json
//! {"format": "sinew latent model", "version": 1, "state": "h32", "frame_rate": 20.0, "free": 6, "kind": "gpdm", "model": {"columns": 26, …}}
//! ```
//!
//! Numbers are written with the digits that read back as the same bits. What is read is checked whole ([`crate::check`]), so that all maps of a model from a file are made and used without an error. Memory is at most a small multiple of the
//! text's length, but for the covariances, whose size is bounded.

use crate::Error;
use crate::check::{covers, sizes};
use crate::model::{LatentModel, RootPrior};
use serde::{Deserialize, Serialize};
use sinew_dynamics::model_file::{self, ModelFormat};
use std::fmt;

pub use sinew_dynamics::model_file::MAX_BYTES;

/// The format.
pub const FORMAT: ModelFormat =
    ModelFormat { what: "latent model", name: "sinew latent model", version: 1, command: "sinew learn latent" };

/// A file that is no latent model.
pub type LatentFileError = model_file::ModelFileProblem<Error>;

/// The kinds of models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LatentKind {
    /// [`crate::gplvm`].
    Gplvm,
    /// [`crate::gpdm`].
    Gpdm,
    /// [`crate::hgplvm`].
    Hgplvm,
}

impl LatentKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Gplvm, Self::Gpdm, Self::Hgplvm];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gplvm => "gplvm",
            Self::Gpdm => "gpdm",
            Self::Hgplvm => "hgplvm",
        }
    }

    /// The kind of that name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl fmt::Display for LatentKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A model with what its rows are.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredModel {
    /// What the rows are states of: the name of a body.
    pub state: String,
    /// Rows per second.
    pub frame_rate: f64,
    /// Leading coordinates of a state that are not in the model: position and orientation of the root.
    pub free: usize,
    /// What kind of model it is.
    pub kind: LatentKind,
    /// The model of the other coordinates.
    pub model: LatentModel,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Whole {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u64,
    state: String,
    frame_rate: f64,
    free: usize,
    kind: LatentKind,
    model: LatentModel,
}

#[derive(Serialize)]
struct Written<'a> {
    format: &'a str,
    version: u64,
    state: &'a str,
    frame_rate: f64,
    free: usize,
    kind: LatentKind,
    model: &'a LatentModel,
}

/// Characters of the name of a state at most.
const LONGEST_NAME: usize = 100;
/// Coordinates that are not in the model, at most.
const MOST_FREE: usize = 100;
/// Rows a second at most.
const FASTEST: f64 = 1e5;

/// Everything that a model in a file fulfils, so that its maps are made and used without an error.
///
/// # Errors
/// [`Error::Head`], [`Error::Kind`], [`Error::TooMany`], [`Error::Shape`] and [`Error::OutOfRange`].
pub fn check(stored: &StoredModel) -> Result<(), Error> {
    let StoredModel { state, frame_rate, free, kind, model } = stored;
    let head = |key, found, expected| Err(Error::Head { key, found, expected });
    if !(1..=LONGEST_NAME).contains(&state.chars().count()) || state.chars().any(char::is_control) {
        let shown: String = state.chars().take(40).collect();
        return head("state", format!("{shown:?}"), "a name of 1 to 100 characters");
    }
    if !(*frame_rate >= FASTEST.recip() && *frame_rate <= FASTEST) {
        return head("frame_rate", frame_rate.to_string(), "1e-5 to 1e5 frames a second");
    }
    if *free > MOST_FREE {
        return head("free", free.to_string(), "at most 100 coordinates that are not in the model");
    }
    sizes(model)?;
    model.check()?;
    covers(model)?;
    let has_dynamics = matches!(model.prior, RootPrior::Dynamics { .. });
    let fits = match kind {
        LatentKind::Gplvm => model.nodes.len() == 1 && !has_dynamics,
        LatentKind::Gpdm => model.nodes.len() == 1 && has_dynamics,
        LatentKind::Hgplvm => has_dynamics,
    };
    if fits { Ok(()) } else { Err(Error::Kind { kind: kind.name(), nodes: model.nodes.len(), has_dynamics }) }
}

/// Reads and checks a model; `name` is what errors call the file.
///
/// # Errors
/// [`LatentFileError`]; any text gets a model or an error.
pub fn read(name: &str, text: &str) -> Result<StoredModel, LatentFileError> {
    let Whole { state, frame_rate, free, kind, model, .. } = model_file::read(FORMAT, name, text)?;
    let stored = StoredModel { state, frame_rate, free, kind, model };
    match check(&stored) {
        Ok(()) => Ok(stored),
        Err(misfit) => Err(LatentFileError::Value { file: name.to_owned(), format: FORMAT, misfit }),
    }
}

/// The text of a model's file, one line; `name` is what errors call the file.
///
/// # Errors
/// [`LatentFileError::Value`] for a model that [`read`] would refuse.
pub fn write(name: &str, stored: &StoredModel) -> Result<String, LatentFileError> {
    check(stored).map_err(|misfit| LatentFileError::Value { file: name.to_owned(), format: FORMAT, misfit })?;
    let StoredModel { state, frame_rate, free, kind, model } = stored;
    let (format, version) = (FORMAT.name, FORMAT.version);
    let written = Written { format, version, state, frame_rate: *frame_rate, free: *free, kind: *kind, model };
    model_file::write(FORMAT, name, &written)
}
