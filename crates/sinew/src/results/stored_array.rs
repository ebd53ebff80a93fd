//! Arrays of numbers of a result folder's `posterior.zarr`.

use crate::Error;
use crate::files::{read_bytes, read_text};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::zarr::reader::{self, NumberArray};
use std::path::Path;

/// The array at a path of the store, such as `constant_data/camera_centre`; `None` where there is none.
///
/// # Errors
/// Files that cannot be read, arrays of another kind.
pub fn stored_array(folder: &Path, path: &str) -> Result<Option<NumberArray>, Error> {
    let array = folder.join("posterior.zarr").join(path);
    let document = array.join("zarr.json");
    if !document.is_file() {
        return Ok(None);
    }
    let text = read_text(&document, MAX_TEXT_BYTES)?;
    let mut failed = None;
    let read = reader::numbers(&document.display().to_string(), &text, |key| {
        let path = array.join(key);
        let bytes = path.exists().then(|| read_bytes(&path, MAX_TEXT_BYTES)).transpose();
        Ok(bytes.unwrap_or_else(|error| {
            failed.get_or_insert(error);
            None
        }))
    });
    failed.map_or(Ok(()), Err)?;
    Ok(Some(read?))
}
