//! Reading whole files: size checked before memory is taken, text decoded, every failure with its path.

use crate::Error;
use crate::folder_contents::folder_contents;
use crate::input_error::InputError;
use sinew_formats::source_text::{check_size, decode};
use std::fs;
use std::io::Read as _;
use std::path::Path;

/// Bytes of a file of at most `limit` bytes.
///
/// # Errors
/// [`Error::Io`] with the path, [`Error::Input`] for a folder, [`Error::Format`] for a file that is too large.
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    if path.is_dir() {
        return Err(InputError::FolderForFile { folder: path.to_owned(), contents: folder_contents(path) }.into());
    }
    let file = fs::File::open(path).map_err(Error::io("read", path))?;
    let size = file.metadata().map_err(Error::io("read", path))?.len();
    let shown = path.display().to_string();
    check_size(&shown, size, limit)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    check_size(&shown, bytes.len() as u64, limit)?;
    Ok(bytes)
}

/// Text of a file of at most `limit` bytes.
///
/// # Errors
/// As [`read_bytes`], and for bytes that are not UTF-8.
pub fn read_text(path: &Path, limit: u64) -> Result<String, Error> {
    let bytes = read_bytes(path, limit)?;
    Ok(decode(&path.display().to_string(), &bytes, limit)?.to_owned())
}

/// The first bytes of a file, as far as they are text: enough to see of which kind it is.
///
/// # Errors
/// [`Error::Io`] with the path.
pub fn read_beginning(path: &Path) -> Result<String, Error> {
    const BYTES: u64 = 1 << 16;
    let file = fs::File::open(path).map_err(Error::io("read", path))?;
    let mut bytes = Vec::new();
    file.take(BYTES).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Start value of [`fnv`].
pub const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;

/// Folds bytes into a hash (FNV-1a, 64 bits; Fowler, Noll & Vo): to distinguish files and settings; it keeps no secrets.
#[must_use]
pub fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
