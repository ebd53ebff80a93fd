//! Arrays of numbers of a result folder's `posterior.zarr`.

use super::stored_file::read_stored;
use crate::Error;
use crate::storage::{Disk, Storage};
use sinew_formats::source_text::{MAX_TEXT_BYTES, decode};
use sinew_formats::zarr::reader::{self, NumberArray};
use std::path::Path;

/// The array at a path of the store, such as `constant_data/camera_centre`; `None` where there is none.
///
/// # Errors
/// Files that cannot be read, arrays of another kind.
pub fn stored_array(folder: &Path, path: &str) -> Result<Option<NumberArray>, Error> {
    stored_array_in(&Disk, folder, path)
}

/// As [`stored_array`], with the folder in a storage.
///
/// # Errors
/// As [`stored_array`].
pub fn stored_array_in(storage: &dyn Storage, folder: &Path, path: &str) -> Result<Option<NumberArray>, Error> {
    let array = folder.join("posterior.zarr").join(path);
    let document = array.join("zarr.json");
    if !storage.exists(&document) {
        return Ok(None);
    }
    let name = document.display().to_string();
    let bytes = read_stored(storage, &document, MAX_TEXT_BYTES)?;
    let mut failed = None;
    let read = reader::numbers(&name, decode(&name, &bytes, MAX_TEXT_BYTES)?, |key| {
        let path = array.join(key);
        let bytes = storage.exists(&path).then(|| read_stored(storage, &path, MAX_TEXT_BYTES)).transpose();
        Ok(bytes.unwrap_or_else(|error| {
            failed.get_or_insert(error);
            None
        }))
    });
    failed.map_or(Ok(()), Err)?;
    Ok(Some(read?))
}
