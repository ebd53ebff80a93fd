//! Which settings a configuration sets.

use super::facts::Facts;
use crate::Error;
use sinew::config::file;
use sinew::config::table::settings;
use sinew::config::value::to_toml;
use std::path::Path;

pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let config = file::read(path)?;
    let count = config.values.len();
    let mut facts = Facts::new(format!("{}: configuration that sets {count} of {}", path.display(), settings().len()));
    if config.is_root {
        facts.row(file::ROOT, "true: files in the folders above do not count");
    }
    for setting in settings() {
        if let Some(value) = config.values.get(setting.key) {
            facts.row(setting.key, to_toml(value));
        }
    }
    Ok(facts)
}
