//! What this crate refuses.

/// Everything that can stop a tracker.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is outside its range.
    #[error("{name} is {value}; {expected}")]
    Config {
        /// Which.
        name: &'static str,
        /// Value found.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// The state has another dimension than the motion model or the observation.
    #[error("{name} has dimension {found}; expected {expected}")]
    Dimension {
        /// What.
        name: &'static str,
        /// Dimension found.
        found: usize,
        /// Dimension expected.
        expected: usize,
    },
    /// A decoder or a transition cannot be made.
    #[error(transparent)]
    Core(#[from] sinew_core::Error),
    /// A sampler refused.
    #[error(transparent)]
    Samplers(#[from] sinew_samplers::Error),
    /// The motion model has no prior for the next frame.
    #[error("no prior for the next frame")]
    Prior(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// A tracker of a latent state cannot start at a pose.
    #[error("no sampled state decodes to the pose to start at")]
    NotEncoded,
    /// Tracking stopped in a frame.
    #[error("frame {frame}")]
    Frame {
        /// The frame.
        frame: u32,
        /// Why.
        source: Box<Error>,
    },
}

/// Refuses another dimension, or number of parts, than the expected one.
pub(crate) fn check_dimension(name: &'static str, found: usize, expected: usize) -> Result<(), Error> {
    if found == expected { Ok(()) } else { Err(Error::Dimension { name, found, expected }) }
}
