//! What keeps a body from being drawn.

/// Pictures that cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OverlayError {
    /// Solids that do not fit the body.
    #[error("{0}")]
    Solids(sinew_body::Error),
    /// A scale of pictures that is no positive number.
    #[error("`--mask-scale` is {scale}; it must be greater than 0")]
    Scale {
        /// The scale.
        scale: f64,
    },
    /// Frames without images.
    #[error("none of the frames to be drawn has an image")]
    NoImages,
}

impl OverlayError {
    /// Code with which the program ends.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::Scale { .. } => 2,
            Self::Solids(_) | Self::NoImages => 3,
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub const fn help(&self) -> Option<&'static str> {
        match self {
            Self::Solids(_) => None,
            Self::Scale { .. } => {
                Some("it is the size of the pictures over that of the calibrated images, for example 0.5")
            }
            Self::NoImages => Some("choose others with `--frames` and `--every`, or leave the folder of images out"),
        }
    }
}
