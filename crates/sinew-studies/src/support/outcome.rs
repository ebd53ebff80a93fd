//! What a chore returns: a value, or any error that can be printed.

use std::error::Error;
use std::process::ExitCode;

/// A result whose error is only printed.
pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// The exit code of a chore; an error is printed.
pub(crate) fn exit_code(outcome: Outcome<ExitCode>) -> ExitCode {
    outcome.unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}
