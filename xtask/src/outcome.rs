//! What a chore returns: a value, or any error that can be printed.

use std::error::Error;

/// A result whose error is only printed.
pub(crate) type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;
