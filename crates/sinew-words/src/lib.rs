//! What the programs say of errors beside the errors' own words: what can be done about each, and the code with which a program ends.
//!
//! Enter: errors of the libraries, which are kinds with values and know no flags. Leave: sentences in the notation of the command line ([`help`]), which the Python package turns into keyword arguments, and exit codes ([`exit_codes`]). A file per station.
//! Must not know: a terminal, or how anything is computed.

mod analysis;
pub mod exit_codes;
mod formats;
mod input;
mod models;
mod motion;
mod report;
mod results;
mod setup;
mod track;

pub use exit_codes::exit_code;
pub use report::{help, odd};
pub use track::help as help_with_run;
