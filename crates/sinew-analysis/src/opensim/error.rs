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

impl OpensimError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        3
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::NoMarker { .. } => {
                "track with a body that has hips, knees, ankles and shoulders, such as h32; bodies of the model are \
                 expected under the names of Rajagopal's (femur_r, tibia_r, talus_r, torso …)"
            }
            Self::NoSpread { .. } => "take the folder as the run left it, or track again",
        }
    }
}
