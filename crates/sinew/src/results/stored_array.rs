//! Arrays of a result folder's `posterior.zarr`.

use crate::Error;
use crate::files::{read_bytes, read_text};
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::zarr::reader::{self, NumberArray, StoredArray};
use std::path::{Path, PathBuf};

/// Name of the document that every node of a store has.
const DOCUMENT: &str = "zarr.json";

/// The array of numbers at a path of the store, such as `constant_data/camera_centre`; `None` where there is none.
///
/// # Errors
/// Files that cannot be read, arrays of another kind.
pub fn stored_array(folder: &Path, path: &str) -> Result<Option<NumberArray>, Error> {
    let array = folder.join("posterior.zarr").join(path);
    if !array.join(DOCUMENT).is_file() {
        return Ok(None);
    }
    read_array(&array, |name, text, chunks| reader::numbers(name, text, chunks)).map(Some)
}

/// A group of a store.
#[derive(Clone, Debug)]
pub struct StoredGroup {
    /// Its attributes.
    pub attributes: serde_json::Map<String, serde_json::Value>,
    /// Its arrays by name, coordinates included.
    pub arrays: Vec<(String, StoredArray)>,
}

/// Names of the groups of a store, sorted.
///
/// # Errors
/// A folder that cannot be read.
pub fn stored_groups(store: &Path) -> Result<Vec<String>, Error> {
    Ok(nodes(store)?.into_iter().map(|(name, _)| name).collect())
}

/// A group of a store, such as `posterior` of `posterior.zarr`, with all its numbers.
///
/// # Errors
/// Files that cannot be read, arrays that are not of our kind.
pub fn stored_group(store: &Path, group: &str) -> Result<StoredGroup, Error> {
    let folder = store.join(group);
    let document = folder.join(DOCUMENT);
    let text = read_text(&document, MAX_TEXT_BYTES)?;
    let parsed: serde_json::Value = json_text::parse(&document.display().to_string(), &text)?;
    let attributes = parsed["attributes"].as_object().cloned().unwrap_or_default();
    let read = |path: &Path| read_array(path, |name, text, chunks| reader::array(name, text, chunks));
    let arrays = nodes(&folder)?.into_iter().map(|(name, path)| Ok((name, read(&path)?)));
    Ok(StoredGroup { attributes, arrays: arrays.collect::<Result<_, Error>>()? })
}

/// Nodes right below a folder, by name.
fn nodes(folder: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let mut nodes = vec![];
    for entry in std::fs::read_dir(folder).map_err(Error::io("read", folder))? {
        let path = entry.map_err(Error::io("read", folder))?.path();
        let name = path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
        nodes.extend(name.filter(|_| path.join(DOCUMENT).is_file()).map(|name| (name, path)));
    }
    nodes.sort();
    Ok(nodes)
}

/// The chunks of an array by key.
type Chunks<'a> = &'a mut dyn FnMut(&str) -> Result<Option<Vec<u8>>, sinew_formats::Error>;

fn read_array<T>(
    array: &Path,
    read: impl Fn(&str, &str, Chunks<'_>) -> Result<T, sinew_formats::Error>,
) -> Result<T, Error> {
    let document = array.join(DOCUMENT);
    let text = read_text(&document, MAX_TEXT_BYTES)?;
    let mut failed = None;
    let mut chunk = |key: &str| {
        let path = array.join(key);
        let bytes = path.exists().then(|| read_bytes(&path, MAX_TEXT_BYTES)).transpose();
        Ok(bytes.unwrap_or_else(|error| {
            failed.get_or_insert(error);
            None
        }))
    };
    let read = read(&document.display().to_string(), &text, &mut chunk);
    failed.map_or(Ok(()), Err)?;
    Ok(read?)
}
