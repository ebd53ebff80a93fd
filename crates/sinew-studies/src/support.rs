//! What studies share: where they stand, what they keep, how they draw and run the program.

pub(crate) mod chart;
pub(crate) mod outcome;
pub(crate) mod primitives;
pub(crate) mod processor_time;
pub(crate) mod program;
pub(crate) mod statistics;
pub(crate) mod store;
pub(crate) mod study_options;
pub(crate) mod table;

use std::path::Path;

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new("."))
}
