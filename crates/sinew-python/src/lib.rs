//! The Python package `sinew`: arrays in, arrays out, with the kernels and the words of the library.
//!
//! The classes and functions here are those that `python/sinew` shows; their documentation is Python's, with shapes and units. Everything runs without the interpreter's lock, and a panic becomes an exception.

mod arrays;
mod background;
mod body;
mod camera;
mod failure;
mod triangulation;

use pyo3::prelude::*;

#[pymodule]
fn _sinew(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<body::PyBody>()?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<triangulation::PyTriangulated>()?;
    module.add_function(wrap_pyfunction!(triangulation::triangulate, module)?)?;
    Ok(())
}
