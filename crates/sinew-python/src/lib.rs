//! The Python package `sinew`: arrays in, arrays out, with the kernels and the words of the library.
//!
//! The classes and functions here are the ones that `python/sinew` shows; their documentation is Python's, with shapes and units. Everything runs without the interpreter's lock, and a panic becomes an exception.

mod arrays;
mod background;
mod body;
mod camera;
mod chains;
mod failure;
mod files;
mod given;
mod keypoints;
mod log_density;
mod motion;
mod particles;
mod run;
mod simulation;
mod store;
mod triangulation;

use pyo3::prelude::*;

#[pymodule]
fn _sinew(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<body::PyBody>()?;
    module.add_class::<camera::PyCamera>()?;
    module.add_class::<motion::PyMotion>()?;
    module.add_function(wrap_pyfunction!(triangulation::triangulate, module)?)?;
    module.add_function(wrap_pyfunction!(chains::no_u_turn, module)?)?;
    module.add_function(wrap_pyfunction!(chains::hamiltonian, module)?)?;
    module.add_function(wrap_pyfunction!(particles::normalise, module)?)?;
    module.add_function(wrap_pyfunction!(particles::effective_number, module)?)?;
    module.add_function(wrap_pyfunction!(particles::resample, module)?)?;
    module.add_function(wrap_pyfunction!(particles::tempering_exponent, module)?)?;
    module.add_function(wrap_pyfunction!(particles::r_hat, module)?)?;
    module.add_function(wrap_pyfunction!(particles::bulk_ess, module)?)?;
    module.add_function(wrap_pyfunction!(particles::tail_ess, module)?)?;
    module.add_function(wrap_pyfunction!(run::track, module)?)?;
    module.add_function(wrap_pyfunction!(run::settings_table, module)?)?;
    module.add_function(wrap_pyfunction!(store::zarr_groups, module)?)?;
    module.add_function(wrap_pyfunction!(store::zarr_group, module)?)?;
    module.add_function(wrap_pyfunction!(simulation::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(motion::read_motion, module)?)?;
    module.add_function(wrap_pyfunction!(motion::write_motion, module)?)?;
    module.add_function(wrap_pyfunction!(motion::restored_motion, module)?)?;
    module.add_function(wrap_pyfunction!(files::kind, module)?)?;
    module.add_function(wrap_pyfunction!(files::read_calibration, module)?)?;
    module.add_function(wrap_pyfunction!(files::write_calibration, module)?)?;
    module.add_function(wrap_pyfunction!(files::write_body, module)?)?;
    module.add_function(wrap_pyfunction!(files::read_picture, module)?)?;
    module.add_function(wrap_pyfunction!(files::read_mask, module)?)?;
    module.add_function(wrap_pyfunction!(files::write_picture, module)?)?;
    module.add_function(wrap_pyfunction!(files::write_mask, module)?)?;
    module.add_function(wrap_pyfunction!(files::layouts, module)?)?;
    module.add_function(wrap_pyfunction!(files::read_layout, module)?)?;
    module.add_function(wrap_pyfunction!(keypoints::read_keypoints, module)?)?;
    module.add_function(wrap_pyfunction!(keypoints::write_keypoints, module)?)?;
    Ok(())
}
