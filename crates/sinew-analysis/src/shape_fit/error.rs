//! What keeps thicknesses from being fitted to masks.

/// Masks or solids that cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeFitError {
    /// Solids that no body has.
    #[error("{0}")]
    Solids(sinew_body::Error),
    /// Masks of another size than their camera.
    #[error("{camera}: masks of {size:?} pixels, the camera has {expected:?}")]
    OtherSize {
        /// Camera.
        camera: String,
        /// Size of the mask, pixels.
        size: [usize; 2],
        /// Size of the camera's images, pixels.
        expected: [usize; 2],
    },
    /// Masks without anybody.
    #[error("none of the frames chosen has a mask with a person")]
    Nobody,
}
