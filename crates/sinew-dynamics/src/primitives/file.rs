//! The file of a motion model: JSON with a name of the format and a version.
//!
//! ```json
//! {"format": "sinew motion model", "version": 1, "model": {"state": "h32", "dim": 32, …}}
//! ```
//!
//! Numbers are written with the digits that read back as the same bits. What is read is checked whole ([`crate::primitives::check`]), so that a model from a file moves states without an error.
//! Memory is at most a small multiple of the text's length.

use crate::primitives::check::{Misfit, check};
use crate::primitives::model::PrimitiveModel;
use serde::{Deserialize, Serialize};

/// Name of the format.
pub const FORMAT: &str = "sinew motion model";

/// The version that is written and read.
pub const VERSION: u64 = 1;

/// Text of a file at most; a model of 14 feature vectors with 80 clusters each has 2 MB.
pub const MAX_BYTES: u64 = 64 << 20;

/// A file that is no motion model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelFileError {
    /// Text that is no JSON, or JSON of another shape.
    #[error("{file} is no motion model: {problem}")]
    Json {
        /// Name of the file.
        file: String,
        /// What the parser says, with line and column.
        problem: String,
    },
    /// JSON of another program.
    #[error("{file} is no motion model: its `format` is \"{found}\"; expected \"{FORMAT}\"")]
    Format {
        /// Name of the file.
        file: String,
        /// Format found.
        found: String,
    },
    /// A version that is not known.
    #[error("{file} is a motion model of version {found}; expected {VERSION}")]
    Version {
        /// Name of the file.
        file: String,
        /// Version found.
        found: u64,
    },
    /// A value that no model has.
    #[error("{file}: {misfit}")]
    Value {
        /// Name of the file.
        file: String,
        /// Place, what was found and what was expected.
        misfit: Misfit,
    },
}

impl ModelFileError {
    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Json { .. } | Self::Format { .. } => {
                "give a file that `sinew learn primitives` wrote; if it did write this one, learn the model again"
            }
            Self::Version { .. } => "learn the model again with this version of sinew: `sinew learn primitives`",
            Self::Value { .. } => {
                "the file was changed or damaged after it was written; learn the model again: `sinew learn primitives`"
            }
        }
    }
}

/// What every version has.
#[derive(Deserialize)]
struct Head {
    format: String,
    version: u64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Whole {
    #[serde(rename = "format")]
    _format: String,
    #[serde(rename = "version")]
    _version: u64,
    model: PrimitiveModel,
}

#[derive(Serialize)]
struct Written<'a> {
    format: &'a str,
    version: u64,
    model: &'a PrimitiveModel,
}

/// Characters at the start of a file within which its format stands.
const HEAD: usize = 200;

/// Whether a text says that it is a motion model, of whatever version and whether it is whole or not.
#[must_use]
pub fn is_motion_model(text: &str) -> bool {
    let head: String = text.chars().take(HEAD).collect();
    head.trim_start().starts_with('{') && head.contains(&format!("\"{FORMAT}\""))
}

/// Reads and checks a model; `name` is what errors call the file.
///
/// # Errors
/// [`ModelFileError`]; any text gets a model or an error.
pub fn read(name: &str, text: &str) -> Result<PrimitiveModel, ModelFileError> {
    let file = || name.to_owned();
    let json = |error: serde_json::Error| ModelFileError::Json { file: file(), problem: error.to_string() };
    let head: Head = serde_json::from_str(text).map_err(json)?;
    if head.format != FORMAT {
        let found = head.format.chars().take(40).collect();
        return Err(ModelFileError::Format { file: file(), found });
    }
    if head.version != VERSION {
        return Err(ModelFileError::Version { file: file(), found: head.version });
    }
    let Whole { model, .. } = serde_json::from_str(text).map_err(json)?;
    match check(&model) {
        Ok(()) => Ok(model),
        Err(misfit) => Err(ModelFileError::Value { file: file(), misfit }),
    }
}

/// The text of a model's file, one line; `name` is what errors call the file.
///
/// # Errors
/// [`ModelFileError::Value`] for a model that [`read`] would refuse.
pub fn write(name: &str, model: &PrimitiveModel) -> Result<String, ModelFileError> {
    check(model).map_err(|misfit| ModelFileError::Value { file: name.to_owned(), misfit })?;
    let written = serde_json::to_string(&Written { format: FORMAT, version: VERSION, model });
    let text = written.map_err(|error| ModelFileError::Json { file: name.to_owned(), problem: error.to_string() })?;
    Ok(text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::model;

    #[test]
    fn models_are_read_bit_for_bit_as_written() {
        let mut learned = model();
        learned.noise_sd[0] = f64::from_bits(0x3fb9_9999_9999_999b);
        let text = write("m.json", &learned).expect("a learned model");
        let again = read("m.json", &text).expect("what was written");
        assert_eq!(again, learned);
        assert_eq!(write("m.json", &again).expect("a model that was read"), text);
        assert!(is_motion_model(&text) && !is_motion_model("{}") && text.len() < MAX_BYTES as usize);
    }

    #[test]
    fn other_files_and_versions_are_refused() {
        let text = write("m.json", &model()).expect("a learned model");
        let refused = |text: &str| read("m.json", text).unwrap_err();
        assert_eq!(
            refused(&text.replace("\"version\":1", "\"version\":2")).to_string(),
            "m.json is a motion model of version 2; expected 1"
        );
        assert_eq!(
            refused("{\"format\": \"zarr\", \"version\": 3}").to_string(),
            "m.json is no motion model: its `format` is \"zarr\"; expected \"sinew motion model\""
        );
        let cut = refused(&text[..text.len() / 2]);
        assert!(matches!(&cut, ModelFileError::Json { problem, .. } if problem.contains("line 1 column")), "{cut}");
        for (from, to) in [
            ("\"version\":1", "\"version\":1,\"more\":0"),
            ("\"version\":1", "\"version\":-1"),
            ("\"dim\":4", "\"dim\":4,\"dim\":4"),
            ("\"dim\":4", "\"dim\":18446744073709551616"),
            ("\"length\":3", "\"length\":null"),
            ("\"frame_rate\":20.0", "\"frame_rate\":1e999"),
        ] {
            assert!(text.contains(from), "{from}");
            let error = refused(&text.replace(from, to));
            assert!(matches!(error, ModelFileError::Json { .. }), "{to}: {error}");
            assert!(error.help().contains("learn"));
        }
    }
}
