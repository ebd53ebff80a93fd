//! Why a scene cannot be simulated.

use sinew_body::standard::EVALUATION_JOINTS;

/// What a simulation refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Points that a body hangs on and that the motion lacks.
    #[error("the motion has no {}", .0.join(", "))]
    MissingJoints(Vec<&'static str>),
    /// A motion with a coordinate that is not a number.
    #[error("a coordinate of the motion is not finite")]
    NotFinite,
    /// Cameras that cannot stand around the motion.
    #[error(transparent)]
    Camera(#[from] sinew_observe::Error),
}

impl Error {
    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> Option<String> {
        match self {
            Self::MissingJoints(_) => Some(format!("a body needs the points {}", EVALUATION_JOINTS.join(", "))),
            Self::NotFinite | Self::Camera(_) => None,
        }
    }
}
