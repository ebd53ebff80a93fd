//! What is computed from recordings and results, and is no run.
//!
//! | module | what |
//! |---|---|
//! | [`mod@compare`] | a result beside a laboratory's markers or another program's angles |
//! | [`mod@gait`] | events, strides and cycles of a person who walks, from a result |
//! | [`opensim`] | a result as input of OpenSim's scaling and inverse kinematics |
//! | [`mod@segment`] | masks from images of fixed cameras |
//! | [`shape_fit`] | thicknesses of a body from masks and a result |
//! | [`sync`] | how late cameras are against each other |
//! | [`validate`] | a camera that a run did not use, beside what the run predicts of it |

pub mod compare;
mod error;
pub mod gait;
pub mod opensim;
pub mod segment;
pub mod shape_fit;
pub mod sync;
pub mod validate;

pub use error::Error;
