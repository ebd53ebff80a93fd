//! What is noted of a frame once it is tracked, until it is described.

use super::scene::Shown;
use sinew_tracking::StepInfo;

/// What a frame's description needs beside its draws.
pub(super) struct Noted {
    /// Number of the frame.
    pub number: u64,
    /// What the tracker says.
    pub info: StepInfo,
    /// What the frame shows.
    pub shown: Shown,
    /// Cameras whose masks show the person.
    pub silhouettes: usize,
}
