//! Metadata documents: `zarr.json` of groups and arrays.

use super::schema::DataType;
use serde_json::{Map, Value, json};

/// Element of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Element {
    Number(DataType),
    Text,
}

impl Element {
    fn name(self) -> &'static str {
        match self {
            Self::Number(DataType::Float32) => "float32",
            Self::Number(DataType::Float64) => "float64",
            Self::Number(DataType::Int64) => "int64",
            Self::Number(DataType::Bool) => "bool",
            Self::Text => "string",
        }
    }

    fn fill_value(self) -> Value {
        match self {
            Self::Number(DataType::Float32 | DataType::Float64) => json!("NaN"),
            Self::Number(DataType::Int64) => json!(0),
            Self::Number(DataType::Bool) => json!(false),
            Self::Text => json!(""),
        }
    }

    fn codecs(self) -> Value {
        match self {
            Self::Number(_) => json!([{ "name": "bytes", "configuration": { "endian": "little" } }]),
            Self::Text => json!([{ "name": "vlen-utf8" }]),
        }
    }
}

/// The key of a chunk below its array, by its place along each dimension: without folders, of which a store would have more than files.
pub(super) fn chunk_key(places: impl IntoIterator<Item = usize>) -> String {
    places.into_iter().fold("c".to_owned(), |key, place| format!("{key}.{place}"))
}

pub(super) fn array(
    element: Element,
    shape: &[usize],
    chunk: &[usize],
    dimensions: &[String],
    attributes: &Map<String, Value>,
) -> Value {
    json!({
        "zarr_format": 3,
        "node_type": "array",
        "shape": shape,
        "data_type": element.name(),
        "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": chunk } },
        "chunk_key_encoding": { "name": "default", "configuration": { "separator": "." } },
        "fill_value": element.fill_value(),
        "codecs": element.codecs(),
        "attributes": attributes,
        "dimension_names": dimensions,
        "storage_transformers": [],
    })
}

pub(super) fn group(attributes: &Map<String, Value>) -> Value {
    json!({ "zarr_format": 3, "node_type": "group", "attributes": attributes })
}

/// The root's document with the documents of all nodes below it, by path.
pub(super) fn consolidated_root(attributes: &Map<String, Value>, nodes: Map<String, Value>) -> Value {
    let mut root = group(attributes);
    if let Some(document) = root.as_object_mut() {
        let inline = json!({ "kind": "inline", "must_understand": false, "metadata": nodes });
        document.insert("consolidated_metadata".into(), inline);
    }
    root
}

/// A document as bytes.
pub(super) fn bytes(document: &Value) -> Vec<u8> {
    format!("{document:#}\n").into_bytes()
}
