//! What can be wrong with a camera or with what it saw.

/// Everything that this crate refuses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A focal length or an image size that is zero, negative or NaN.
    #[error("{camera}: {field} = {value}; must be positive")]
    NotPositive {
        /// Camera at fault.
        camera: String,
        /// Name of the number.
        field: &'static str,
        /// Value found.
        value: f64,
    },
    /// A number is NaN or infinite.
    #[error("{camera}: a number of the calibration is not finite")]
    NotFinite {
        /// Camera at fault.
        camera: String,
    },
    /// The rotation is none.
    #[error("{camera}: R'R differs from identity by {deviation}")]
    NotRotation {
        /// Camera at fault.
        camera: String,
        /// Largest entry of the difference.
        deviation: f64,
    },
    /// The rotation mirrors.
    #[error("{camera}: R is a mirror image (determinant -1); axes are left-handed")]
    MirrorImage {
        /// Camera at fault.
        camera: String,
    },
    /// A camera cannot look at its own centre, nor straight up or down with an upright image.
    #[error("{camera}: no upright view from this place at this target; move one of them sideways")]
    NoView {
        /// Camera at fault.
        camera: String,
    },
    /// A pixel outside the range in which the distortion can be undone.
    #[error("{camera}: pixel ({:.1}, {:.1}) lies beyond the valid radius of the distortion", pixel[0], pixel[1])]
    BeyondLens {
        /// Camera at fault.
        camera: String,
        /// The pixel.
        pixel: [f64; 2],
    },
}
