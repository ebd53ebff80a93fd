//! Why a result cannot become input of OpenSim.

use std::path::PathBuf;

/// A result that OpenSim cannot be given.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OpensimError {
    /// A point without which a model cannot be scaled.
    #[error("{}: no `{missing}` {}", folder.display(), whose(model))]
    NoMarker {
        /// Result folder.
        folder: PathBuf,
        /// The point.
        missing: &'static str,
        /// The model.
        model: Option<PathBuf>,
    },
    /// Standard deviations that are missing or not positive.
    #[error("{}: the standard deviation of `{marker}` is {sd} m in row {row}; must be above 0", file.display())]
    NoSpread {
        /// The table.
        file: PathBuf,
        /// Marker.
        marker: String,
        /// Row, the header being 1.
        row: usize,
        /// What stands there.
        sd: f64,
    },
}

fn whose(model: &Option<PathBuf>) -> String {
    match model {
        Some(model) => format!("that a body of {} could carry", model.display()),
        None => "among its points".into(),
    }
}
