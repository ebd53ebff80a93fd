//! Draws and statistics of a Zarr store as arrays, read once and in the type in which they are stored.

use crate::arrays::array;
use crate::background::detached;
use crate::failure::Failure;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::formats::zarr::reader::{StoredArray, StoredValues};
use sinew::results::stored_array::{stored_group, stored_groups};
use std::path::PathBuf;

/// Names of the groups of a store.
#[pyfunction]
pub(crate) fn zarr_groups(py: Python<'_>, store: PathBuf) -> PyResult<Vec<String>> {
    detached(py, || Ok(stored_groups(&store)?))
}

/// A group: its attributes as JSON, and by name (dimensions, values, attributes as JSON) of each array.
#[pyfunction]
pub(crate) fn zarr_group<'py>(
    py: Python<'py>,
    store: PathBuf,
    group: &str,
) -> PyResult<(String, Bound<'py, PyDict>)> {
    let read = detached(py, || Ok(stored_group(&store, group)?))?;
    let arrays = PyDict::new(py);
    for (name, stored) in read.arrays {
        let StoredArray { shape, dimensions, attributes, values } = stored;
        let values = typed(py, shape, values)?;
        arrays.set_item(name, (dimensions, values, json(&attributes)?))?;
    }
    Ok((json(&read.attributes)?, arrays))
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
