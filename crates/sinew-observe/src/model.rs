//! From an image's content to a density: the seam between observations and trackers.

/// What a set of cameras can see of a body. Binding does the work of a frame once; what comes out owns all that it needs, and trackers know only it.
pub trait ObservationModel {
    /// What was observed in one frame.
    type Frame<'a>;
    /// Log likelihood of the body's state given that frame: a [`sinew_core::density::LogDensity`] at least.
    type Bound;

    /// Binds one frame.
    fn bind(&self, frame: Self::Frame<'_>) -> Self::Bound;
}
