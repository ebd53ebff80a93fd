//! What the fuzz targets call.
//! One check per reader of `sinew-formats` and of the program, and one for a step of a filter.

pub mod checks;
pub mod program_checks;
