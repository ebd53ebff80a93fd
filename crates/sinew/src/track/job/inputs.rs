//! What a run was made from: warnings about its source, and hashes of everything that it read.

use crate::config::Resolved;
use crate::{Error, files};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use std::collections::BTreeMap;

/// Hashes by the name of the input.
pub type Hashes = BTreeMap<String, String>;

/// The source's warnings and hashes, as far as it was read, and the files that settings name.
pub(super) struct Inputs<F> {
    /// Warnings and hashes of a source.
    pub(super) hash_source: F,
    /// Hashes of the files that settings name.
    pub(super) settings_hashes: Hashes,
}

impl<F> Inputs<F> {
    pub(super) fn warnings<S>(&self, source: &S) -> Vec<String>
    where
        F: Fn(&S) -> (Vec<String>, Hashes),
    {
        (self.hash_source)(source).0
    }

    pub(super) fn hashes<S>(&self, source: &S) -> Hashes
    where
        F: Fn(&S) -> (Vec<String>, Hashes),
    {
        let mut hashes = (self.hash_source)(source).1;
        hashes.extend(self.settings_hashes.clone());
        hashes
    }
}

/// Hashes of the files that settings name: set-up, body and layout; the calibration is the source's.
///
/// # Errors
/// A file that cannot be read.
pub(super) fn file_hashes(resolved: &Resolved) -> Result<Hashes, Error> {
    let mut hashes = BTreeMap::new();
    for (key, path) in resolved.files() {
        let text = files::read_text(&path, MAX_TEXT_BYTES)?;
        hashes.insert(key.to_owned(), format!("{:016x}", files::fnv(files::FNV_START, text.as_bytes())));
    }
    Ok(hashes)
}
