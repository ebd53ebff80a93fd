//! Why there is nothing to synchronise.

/// A recording without clocks to compare.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SyncError {
    /// One camera.
    #[error("one camera: there is no other clock to compare its own with")]
    OneCamera,
}
