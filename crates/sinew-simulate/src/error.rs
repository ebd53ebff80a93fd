//! Why a scene cannot be simulated.

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
