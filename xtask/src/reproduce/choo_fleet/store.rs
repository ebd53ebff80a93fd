//! Finished cells on disk, one line of JSON each, so that a run that was stopped goes on with the cell it was in.
//!
//! Every line carries the hash of the configuration that made it. Lines of another configuration are never read.

use super::Outcome;
use serde_json::Value;
use sinew::files::{FNV_START, fnv};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Cells by name.
pub(super) struct Store {
    pub(super) config: String,
    done: BTreeMap<String, Value>,
    file: Mutex<File>,
    pub(super) path: PathBuf,
}

impl Store {
    /// Opens the store of a configuration in a folder.
    pub(super) fn open(folder: &Path, configuration: &str) -> Outcome<Self> {
        fs::create_dir_all(folder)?;
        let config = format!("{:016x}", fnv(FNV_START, configuration.as_bytes()));
        let path = folder.join("cells.jsonl");
        let text = if path.exists() { fs::read_to_string(&path)? } else { String::new() };
        let mut done = BTreeMap::new();
        // A line that was cut short is a cell that was not finished.
        for cell in text.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok()) {
            if cell["config"] == config.as_str()
                && let Some(key) = cell["key"].as_str()
            {
                done.insert(key.to_owned(), cell["value"].clone());
            }
        }
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            writeln!(file)?;
        }
        Ok(Self { config, done, file: Mutex::new(file), path })
    }

    /// A finished cell.
    pub(super) fn get(&self, key: &str) -> Option<&Value> {
        self.done.get(key)
    }

    /// Takes what was kept by [`Store::keep`] into the finished cells.
    pub(super) fn take(&mut self, cells: impl IntoIterator<Item = (String, Value)>) {
        self.done.extend(cells);
    }

    /// Writes a finished cell.
    pub(super) fn keep(&self, key: &str, value: &Value) -> Outcome<()> {
        let line = serde_json::json!({ "config": self.config, "key": key, "value": value });
        let mut file = self.file.lock().map_err(|_| "a writer of cells failed")?;
        writeln!(file, "{line}")?;
        Ok(file.flush()?)
    }
}

/// Numbers of an array.
pub(super) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect()
}

/// Rows of an array of arrays.
pub(super) fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().into_iter().flatten().map(numbers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_again_and_never_those_of_another_configuration() {
        let folder = std::env::temp_dir().join(format!("sinew-store-{}", std::process::id()));
        let store = Store::open(&folder, "one").unwrap();
        store.keep("a", &serde_json::json!([1.0, 2.5])).unwrap();
        // A run that was killed while it wrote.
        fs::write(&store.path, format!("{}{{\"config\": \"on", fs::read_to_string(&store.path).unwrap())).unwrap();
        let again = Store::open(&folder, "one").unwrap();
        assert_eq!(numbers(again.get("a").unwrap()), [1.0, 2.5]);
        again.keep("b", &serde_json::json!(3)).unwrap();
        assert!(Store::open(&folder, "one").unwrap().get("b").is_some());
        assert!(Store::open(&folder, "two").unwrap().get("a").is_none());
        fs::remove_dir_all(&folder).unwrap();
    }
}
