//! The file of a motion model: JSON with a name of the format and a version.
//!
//! ```json
//! {"format": "sinew motion model", "version": 1, "model": {"state": "h32", "dim": 32, …}}
//! ```
//!
//! Numbers are written with the digits that read back as the same bits. What is read is checked whole ([`crate::primitives::check`]), so that a model from a file moves states without an error.
//! The frame of the file is that of [`crate::model_file`].

use crate::model_file::{self, ModelFormat};
use crate::primitives::check::{Misfit, check};
use crate::primitives::model::PrimitiveModel;
use serde::{Deserialize, Serialize};

pub use crate::model_file::MAX_BYTES;

/// The format.
pub const FORMAT: ModelFormat =
    ModelFormat { what: "motion model", name: "sinew motion model", version: 1, command: "sinew learn primitives" };

/// A file that is no motion model.
pub type ModelFileError = model_file::ModelFileProblem<Misfit>;

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

/// Reads and checks a model; `name` is what errors call the file.
///
/// # Errors
/// [`ModelFileError`]; any text gets a model or an error.
pub fn read(name: &str, text: &str) -> Result<PrimitiveModel, ModelFileError> {
    let Whole { model, .. } = model_file::read(FORMAT, name, text)?;
    match check(&model) {
        Ok(()) => Ok(model),
        Err(misfit) => Err(ModelFileError::Value { file: name.to_owned(), format: FORMAT, misfit }),
    }
}

/// The text of a model's file, one line; `name` is what errors call the file.
///
/// # Errors
/// [`ModelFileError::Value`] for a model that [`read`] would refuse.
pub fn write(name: &str, model: &PrimitiveModel) -> Result<String, ModelFileError> {
    check(model).map_err(|misfit| ModelFileError::Value { file: name.to_owned(), format: FORMAT, misfit })?;
    model_file::write(FORMAT, name, &Written { format: FORMAT.name, version: FORMAT.version, model })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::is_of;
    use crate::primitives::made_up::model;

    #[test]
    fn models_are_read_bit_for_bit_as_written() {
        let mut learned = model();
        learned.noise_sd[0] = f64::from_bits(0x3fb9_9999_9999_999b);
        let text = write("m.json", &learned).expect("a learned model");
        let again = read("m.json", &text).expect("what was written");
        assert_eq!(again, learned);
        assert_eq!(write("m.json", &again).expect("a model that was read"), text);
        assert!(is_of(FORMAT, &text) && !is_of(FORMAT, "{}") && text.len() < MAX_BYTES as usize);
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
        }
    }
}
