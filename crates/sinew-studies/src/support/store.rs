//! Finished cells on disk, one line of JSON each.
//!
//! A run that was stopped resumes with the cell that it was in.
//! Every line carries the hash of the configuration that made it. Lines of another configuration are never read.

use crate::support::outcome::Outcome;
use serde_json::Value;
use sinew::files::{FNV_START, fnv};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Cells by name.
pub(crate) struct Store {
    pub(crate) config: String,
    done: BTreeMap<String, Value>,
    file: Mutex<File>,
    pub(crate) path: PathBuf,
}

impl Store {
    /// Opens the store of a configuration in a folder.
    pub(crate) fn open(folder: &Path, configuration: &str) -> Outcome<Self> {
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
    pub(crate) fn get(&self, key: &str) -> Option<&Value> {
        self.done.get(key)
    }

    /// The finished cells of seeds, whose names are that of their kind and the seed.
    pub(crate) fn for_seeds(&self, kind: &str, seeds: impl IntoIterator<Item = u64>) -> Vec<&Value> {
        seeds.into_iter().filter_map(|seed| self.get(&format!("{kind}/{seed}"))).collect()
    }

    /// Takes what was kept by [`Store::keep`] into the finished cells.
    pub(crate) fn take(&mut self, cells: impl IntoIterator<Item = (String, Value)>) {
        self.done.extend(cells);
    }

    /// Writes a finished cell.
    pub(crate) fn keep(&self, key: &str, value: &Value) -> Outcome<()> {
        let line = serde_json::json!({ "config": self.config, "key": key, "value": value });
        let mut file = self.file.lock().map_err(|_| "a writer of cells failed")?;
        writeln!(file, "{line}")?;
        Ok(file.flush()?)
    }
}

/// Something to run: its name, its work in likelihoods, and what it does.
pub(crate) type Task<'a> = (String, f64, Box<dyn Fn() -> Outcome<Value> + Send + Sync + 'a>);

/// Runs what is not done yet, several cells at a time and each on one thread, and takes it into the store.
pub(crate) fn run_all(store: &mut Store, what: &str, tasks: Vec<Task<'_>>, threads: usize) -> Outcome<()> {
    let open: Vec<Task<'_>> = tasks.into_iter().filter(|(key, ..)| store.get(key).is_none()).collect();
    let whole: f64 = open.iter().map(|(_, work, _)| work).sum();
    let (next, clock) = (AtomicUsize::new(0), Instant::now());
    let finished: Mutex<(f64, Vec<(String, Value)>)> = Mutex::new((0.0, vec![]));
    let worker = || -> Outcome<()> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        while let Some((key, work, task)) = open.get(next.fetch_add(1, Ordering::Relaxed)) {
            let value = pool.install(task).map_err(|error| format!("{key}: {error}"))?;
            store.keep(key, &value)?;
            let mut finished = finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.0 += work;
            finished.1.push((key.clone(), value));
            let left = clock.elapsed().as_secs_f64() * (whole / finished.0 - 1.0);
            eprintln!("{what}: {} of {} cells, {left:.0} s left: {key}", finished.1.len(), open.len());
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().map_err(|_| "a worker failed")?).collect::<Outcome<Vec<()>>>()
    })?;
    let (_, cells) = finished.into_inner().unwrap_or_else(PoisonError::into_inner);
    store.take(cells);
    Ok(())
}

/// Numbers of an array.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect()
}

/// Rows of an array of arrays.
pub(crate) fn rows(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().into_iter().flatten().map(numbers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_again_and_never_from_another_configuration() {
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
