//! Why there is nothing to synchronise.

/// A recording without clocks to compare.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SyncError {
    /// One camera.
    #[error("one camera: there is no other clock to compare its own with")]
    OneCamera,
}

impl SyncError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        2
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        "give keypoints of two cameras or more"
    }
}
