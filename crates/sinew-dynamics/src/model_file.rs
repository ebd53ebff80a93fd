//! Files of learned models: JSON that opens with the name of a format and a version.
//!
//! ```json
//! {"format": "sinew motion model", "version": 1, …}
//! ```
//!
//! What each kind of model adds to the two keys, and what it must fulfil, is up to its own module. Memory is at most a small multiple of the text's length.

use core::fmt::{Debug, Display};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Text of a file at most; a motion model of 14 feature vectors with 80 clusters each has 2 MB.
pub const MAX_BYTES: u64 = 64 << 20;

/// A kind of model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModelFormat {
    /// What it is called in messages.
    pub what: &'static str,
    /// What stands at `format`.
    pub name: &'static str,
    /// The version that is written and read.
    pub version: u64,
    /// The command that learns one.
    pub command: &'static str,
}

/// A file that holds no model of the kind that is wanted; `P` says what a value has that no model has.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileProblem<P: Debug + Display> {
    /// Text that is no JSON, or JSON of another shape.
    #[error("{file} is no {}: {problem}", format.what)]
    Json {
        /// Name of the file.
        file: String,
        /// What was expected.
        format: ModelFormat,
        /// What the parser says, with line and column.
        problem: String,
    },
    /// JSON of another program.
    #[error("{file} is no {}: its `format` is \"{found}\"; expected \"{}\"", format.what, format.name)]
    Format {
        /// Name of the file.
        file: String,
        /// What was expected.
        format: ModelFormat,
        /// Format found.
        found: String,
    },
    /// A version that is not known.
    #[error("{file} is a {} of version {found}; expected {}", format.what, format.version)]
    Version {
        /// Name of the file.
        file: String,
        /// What was expected.
        format: ModelFormat,
        /// Version found.
        found: u64,
    },
    /// A value that no model has.
    #[error("{file}: {misfit}")]
    Value {
        /// Name of the file.
        file: String,
        /// What was expected.
        format: ModelFormat,
        /// Place, what was found and what was expected.
        misfit: P,
    },
}

/// What every version has.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u64,
}

/// Characters at the start of a file within which its format stands.
const HEAD: usize = 200;

/// Whether a text says that it is of a format, of whatever version and whether it is whole or not.
#[must_use]
pub fn is_of(format: ModelFormat, text: &str) -> bool {
    let head: String = text.chars().take(HEAD).collect();
    head.trim_start().starts_with('{') && head.contains(&format!("\"{}\"", format.name))
}

/// Reads the whole of a file whose format and version are those that are wanted; `name` is what errors call it.
///
/// # Errors
/// [`ModelFileProblem`] but for [`ModelFileProblem::Value`]: values are still to be checked.
pub fn read<W: DeserializeOwned, P: Debug + Display>(
    format: ModelFormat,
    name: &str,
    text: &str,
) -> Result<W, ModelFileProblem<P>> {
    let file = name.to_owned();
    let json =
        |error: serde_json::Error| ModelFileProblem::Json { file: file.clone(), format, problem: error.to_string() };
    let head: Head = serde_json::from_str(text).map_err(json)?;
    if head.format != format.name {
        let found = head.format.chars().take(40).collect();
        return Err(ModelFileProblem::Format { file, format, found });
    }
    if head.version != format.version {
        return Err(ModelFileProblem::Version { file, format, found: head.version });
    }
    serde_json::from_str(text).map_err(json)
}

/// The text of a file, one line.
///
/// # Errors
/// [`ModelFileProblem::Json`] for what has no JSON.
pub fn write<W: Serialize, P: Debug + Display>(
    format: ModelFormat,
    name: &str,
    whole: &W,
) -> Result<String, ModelFileProblem<P>> {
    let problem = |error: serde_json::Error| error.to_string();
    match serde_json::to_string(whole).map_err(problem) {
        Ok(text) => Ok(text + "\n"),
        Err(problem) => Err(ModelFileProblem::Json { file: name.to_owned(), format, problem }),
    }
}
