//! Draws and statistics of a Zarr store as arrays.
//!
//! They are read once, in the type in which they are stored.

use crate::arrays::array;
use crate::background::{detached, interruptible};
use crate::failure::Failure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::files::{read_bytes, read_text};
use sinew::formats::json_text;
use sinew::formats::source_text::MAX_TEXT_BYTES;
use sinew::formats::zarr::reader::{self, StoredArray, StoredValues};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Name of the document that every node of a store has.
const DOCUMENT: &str = "zarr.json";

/// Names of the groups of a store.
#[pyfunction]
pub(crate) fn zarr_groups(py: Python<'_>, store: PathBuf) -> PyResult<Vec<String>> {
    detached(py, || Ok(nodes(&store)?.into_iter().map(|(name, _)| name).collect()))
}

/// A group: its attributes as JSON, and by name (dimensions, values, attributes as JSON) of each array.
#[pyfunction]
pub(crate) fn zarr_group<'py>(py: Python<'py>, store: PathBuf, group: &str) -> PyResult<(String, Bound<'py, PyDict>)> {
    let stop = Arc::new(AtomicBool::new(false));
    let (attributes, read) = interruptible(
        py,
        &stop,
        |_| Ok(()),
        || {
            let folder = store.join(group);
            let document = folder.join(DOCUMENT);
            let text = read_text(&document, MAX_TEXT_BYTES)?;
            let parsed: serde_json::Value = json_text::parse(&document.display().to_string(), &text)?;
            let attributes = parsed["attributes"].as_object().cloned().unwrap_or_default();
            let arrays = nodes(&folder)?.into_iter().map(|(name, path)| Ok((name, stored(&path, &stop)?)));
            Ok((attributes, arrays.collect::<Result<Vec<_>, Failure>>()?))
        },
    )?;
    let arrays = PyDict::new(py);
    for (name, stored) in read {
        let StoredArray { shape, dimensions, attributes, values } = stored;
        let values = typed(py, shape, values)?;
        arrays.set_item(name, (dimensions, values, json(&attributes)?))?;
    }
    Ok((json(&attributes)?, arrays))
}

/// Nodes right below a folder, by name.
fn nodes(folder: &Path) -> Result<Vec<(String, PathBuf)>, Failure> {
    let mut nodes = vec![];
    for entry in std::fs::read_dir(folder).map_err(sinew::Error::io("read", folder))? {
        let path = entry.map_err(sinew::Error::io("read", folder))?.path();
        let name = path.file_name().and_then(|name| name.to_str()).map(str::to_owned);
        nodes.extend(name.filter(|_| path.join(DOCUMENT).is_file()).map(|name| (name, path)));
    }
    nodes.sort();
    Ok(nodes)
}

/// The array in a folder. After an interrupt no chunk is read any more, and nobody sees what is made of the others.
fn stored(folder: &Path, stop: &AtomicBool) -> Result<StoredArray, Failure> {
    let document = folder.join(DOCUMENT);
    let mut failed = None;
    let text = read_text(&document, MAX_TEXT_BYTES)?;
    let read = reader::array(&document.display().to_string(), &text, |key| {
        let path = folder.join(key);
        let is_wanted = !stop.load(Ordering::Relaxed) && path.exists();
        let bytes = is_wanted.then(|| read_bytes(&path, MAX_TEXT_BYTES)).transpose();
        Ok(bytes.unwrap_or_else(|error| {
            failed.get_or_insert(error);
            None
        }))
    });
    failed.map_or(Ok(()), Err)?;
    Ok(read?)
}

fn json(attributes: &serde_json::Map<String, serde_json::Value>) -> Result<String, Failure> {
    serde_json::to_string(attributes).map_err(|error| Failure::bug(error.to_string()))
}

fn typed<'py>(py: Python<'py>, shape: Vec<usize>, values: StoredValues) -> PyResult<Bound<'py, PyAny>> {
    Ok(match values {
        StoredValues::Float32(values) => array(py, shape, values)?.into_any(),
        StoredValues::Float64(values) => array(py, shape, values)?.into_any(),
        StoredValues::Int64(values) => array(py, shape, values)?.into_any(),
        StoredValues::Bool(values) => array(py, shape, values)?.into_any(),
        StoredValues::Text(values) => {
            let array = py.import("numpy")?.getattr("array")?;
            array.call1((values, "U"))?.call_method1("reshape", (shape,))?
        }
    })
}
