//! What keeps a body from being drawn.

use sinew_input::flag::flag;

/// Pictures that cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// Solids that do not fit the body.
    #[error("{0}")]
    Solids(sinew_body::Error),
    /// A scale of pictures that is no positive number.
    #[error("{} is {scale}; it must be greater than 0", flag("mask_scale"))]
    Scale {
        /// The scale.
        scale: f64,
    },
    /// Frames without images.
    #[error("none of the frames to be drawn has an image")]
    NoImages,
}
