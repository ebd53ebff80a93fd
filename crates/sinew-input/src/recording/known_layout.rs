//! A layout by its name or mapping file, and whether a body can be placed with it.

use crate::input_error::InputError;
use crate::{Error, files};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_formats::{Layout, layout};
use std::path::Path;

/// A built-in layout, or the one of a mapping file.
pub(crate) fn named_layout(name: &str) -> Result<Layout, Error> {
    let path = Path::new(name);
    if path.extension().is_some_and(|extension| extension == "toml") {
        let text = files::read_text(path, MAX_CONFIG_BYTES)?;
        return Ok(layout::read(name, &text)?);
    }
    Ok(layout::find(name)?)
}

/// Points without which a body cannot be placed.
const NEEDED: [(&str, &str); 4] =
    [("LHip", "left hip"), ("RHip", "right hip"), ("LShoulder", "left shoulder"), ("RShoulder", "right shoulder")];

/// The first point that the model needs and a layout lacks, and what it is in words.
pub fn lacking(layout: &Layout) -> Option<(&'static str, &'static str)> {
    NEEDED.iter().find(|(point, _)| layout.index(point).is_none()).copied()
}

/// Refuses a layout with which no body can be placed.
///
/// # Errors
/// The first point that is needed and lacking.
pub fn check_layout(layout: &Layout) -> Result<(), Error> {
    match lacking(layout) {
        None => Ok(()),
        Some((point, words)) => Err(InputError::LayoutLacks { layout: layout.name.clone(), point, words }.into()),
    }
}
