//! Results in a laboratory: held against its markers, and made ready for its programs.
//!
//! | module | what |
//! |---|---|
//! | [`mod@compare`] | a result beside a laboratory's markers or another program's angles |
//! | [`opensim`] | a result as input of OpenSim's scaling and inverse kinematics |

pub mod compare;
mod error;
pub mod opensim;

pub use error::Error;
