//! Why no gait can be read from results.

use std::path::PathBuf;

/// Results that no gait can be read from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GaitError {
    /// A body without the points that a gait is read from.
    #[error("{}: no {}; the body has {}", file.display(), wanted.join(" and no "), found.join(", "))]
    NoPoints {
        /// The table of points.
        file: PathBuf,
        /// Points that are missing.
        wanted: Vec<String>,
        /// Points that are there.
        found: Vec<String>,
    },
    /// Numbers that are not finite, or times that do not rise.
    #[error("{}: {what} in the row of frame {frame}", file.display())]
    NoNumber {
        /// The table.
        file: PathBuf,
        /// What is not a number.
        what: String,
        /// Number of the frame.
        frame: f64,
    },
    /// Nobody walks.
    #[error("{}: nobody walks: no heel strike was found, and the pelvis moves {far_m:.2} m", folder.display())]
    NoSteps {
        /// Result folder.
        folder: PathBuf,
        /// How far the pelvis moves, metres.
        far_m: f64,
    },
}
