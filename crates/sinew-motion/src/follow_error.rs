//! Why a motion cannot be taken.

/// What a motion lacks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FollowError {
    /// A point that a fit needs and that the motion lacks.
    #[error(transparent)]
    Body(#[from] sinew_body::Error),
    /// A motion without frames.
    #[error("a motion without a frame")]
    NoFrames,
    /// A motion along which no pose of a body is found.
    #[error("the joints of the first frame do not determine a pose")]
    NoPose,
    /// Joints of which a motion file has none of the known names.
    #[error("no joint is known as {}", .0.join(", "))]
    UnknownJoints(Vec<&'static str>),
    /// A joint that is not there in all frames of a motion file.
    #[error("{joint} is missing in frame {frame}, counted from 0")]
    Gap {
        /// Our name of the joint.
        joint: &'static str,
        /// The frame, counted from 0.
        frame: usize,
    },
    /// A motion file of one frame.
    #[error("a single frame is no motion")]
    SingleFrame,
    /// A motion file whose legs have no plausible length in any unit.
    #[error("legs of no plausible length in any unit")]
    Unit,
}
