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

impl GaitError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        3
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> String {
        match self {
            Self::NoPoints { .. } => "track with a body that has them, such as h32".into(),
            Self::NoNumber { .. } => "take the folder as the run left it, or track again".into(),
            Self::NoSteps { .. } => "gait needs somebody who takes steps; angles over time are in \
                                     angles.mot, and `sinew report` shows them"
                .into(),
        }
    }
}
