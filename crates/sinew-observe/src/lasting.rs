//! What is constant over a recording and known up to an error.

pub mod drawn_errors;
pub mod lasting_errors;
