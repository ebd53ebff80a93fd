//! Why a scene cannot be simulated.

use sinew_body::standard::EVALUATION_JOINTS;

/// What a simulation refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A sequence without trials.
    #[error("a sequence of no trials")]
    NoTrials,
    /// A trial that a sequence cannot take.
    #[error("the trial {name} {problem}")]
    Trial {
        /// Its name.
        name: String,
        /// What is wrong with it, as the rest of the sentence.
        problem: String,
    },
    /// Points that a body hangs on and that the motion lacks.
    #[error("the motion has no {}", .0.join(", "))]
    MissingJoints(Vec<&'static str>),
    /// A point that a fit needs and that the motion lacks.
    #[error("the motion has no {0}")]
    NoPoint(String),
    /// A motion without frames.
    #[error("a motion without a frame")]
    NoFrames,
    /// A motion with a coordinate that is not a number.
    #[error("a coordinate of the motion is not finite")]
    NotFinite,
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
            Self::UnknownJoints(_) | Self::Gap { .. } | Self::SingleFrame | Self::Unit => Some(NEEDED.into()),
            Self::NoTrials
            | Self::Trial { .. }
            | Self::NoPoint(_)
            | Self::NoFrames
            | Self::NotFinite
            | Self::Camera(_) => None,
        }
    }
}

/// What a motion file must have.
pub const NEEDED: &str = "needed are the positions of neck, head, shoulders, elbows, wrists, hips, knees and ankles, as in BVH files or in `truth.trc` of `sinew demo`";
