//! Hashes of everything that a run was made from.

use crate::config::Resolved;
use crate::input::source::{FrameSource, InputHashes};
use crate::{Error, files};
use sinew_formats::source_text::MAX_TEXT_BYTES;

/// Hashes of a source as far as it was read, and of the files that settings name.
pub(super) fn hashes(source: &impl FrameSource, of_settings: &InputHashes) -> InputHashes {
    source.input_hashes().into_iter().chain(of_settings.clone()).collect()
}

/// Hashes of the files that settings name: set-up, body and layout; the calibration is the source's.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn file_hashes(resolved: &Resolved) -> Result<InputHashes, Error> {
    let mut hashes = InputHashes::new();
    for (key, path) in resolved.files() {
        let text = files::read_text(&path, MAX_TEXT_BYTES)?;
        hashes.insert(key.to_owned(), format!("{:016x}", files::fnv(files::FNV_START, text.as_bytes())));
    }
    Ok(hashes)
}
