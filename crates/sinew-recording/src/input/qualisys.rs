//! Calibrations of Qualisys (`.qca.txt`, XML), which are recognised and refused with a way to convert them.

use super::error::InputError;
use std::fs;
use std::path::Path;

/// Whether a text is such a calibration, whatever its file is called.
#[must_use]
pub fn is_qualisys(text: &str) -> bool {
    let start = text.trim_start_matches('\u{feff}').trim_start();
    start.starts_with('<') && start.contains("<calibration") && start.contains("<fov_")
}

/// Refuses a calibration of Qualisys, and names the `.toml` files beside it.
///
/// # Errors
/// [`InputError::Qualisys`].
pub fn refuse_qualisys(path: &Path, text: &str) -> Result<(), InputError> {
    if !is_qualisys(text) {
        return Ok(());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names = fs::read_dir(folder).into_iter().flatten().flatten().filter_map(|e| e.file_name().into_string().ok());
    let mut beside: Vec<String> = names.filter(|name| name.to_lowercase().ends_with(".toml")).collect();
    beside.sort();
    Err(InputError::Qualisys { file: path.to_owned(), beside })
}
