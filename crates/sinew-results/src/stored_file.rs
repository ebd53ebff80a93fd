//! A file of a result folder, read from whatever storage holds it.

use crate::Error;
use crate::storage::Storage;
use sinew_formats::source_text::check_size;
use std::io::Read as _;
use std::path::Path;

/// Bytes of a file of at most `limit` bytes.
///
/// # Errors
/// A file that cannot be read or written with the path, an error of the format for a file that is too large.
pub fn read_stored(storage: &dyn Storage, path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    let read = storage.read(path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes));
    read.map_err(Error::io("read", path))?;
    check_size(&path.display().to_string(), bytes.len() as u64, limit)?;
    Ok(bytes)
}
