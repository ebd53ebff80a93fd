//! What keeps a model from being learned.

use sinew_dynamics::primitives::file::ModelFileError;
use sinew_latent::file::LatentFileError;
use std::path::PathBuf;

/// Motion from which nothing can be learned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LearnError {
    /// An AMC file without a skeleton beside it.
    #[error("{}: neither `{sought}` nor one single .asf file is beside it", path.display())]
    NoSkeleton {
        /// The AMC file.
        path: PathBuf,
        /// The skeleton that its name suggests.
        sought: String,
    },
    /// A file that no body follows.
    #[error("{}: {problem}", path.display())]
    Follow {
        /// The file.
        path: PathBuf,
        /// Why.
        problem: crate::FollowError,
    },
    /// A file whose joints are no person's.
    #[error("{}: the body misses the recorded joints by {error_m:.1} m on average", path.display())]
    OtherUnits {
        /// The file.
        path: PathBuf,
        /// Mean distance of the joints, metres.
        error_m: f64,
    },
    /// A file of fewer frames than a step has.
    #[error("{}: {frames} frames at {rate_hz} per second; at least 2 are needed", path.display())]
    TooShort {
        /// The file.
        path: PathBuf,
        /// Frames at the working rate.
        frames: usize,
        /// The working rate.
        rate_hz: f64,
    },
    /// Files that are all shorter than a window.
    #[error("no file is long enough for a primitive of {length} frames and the one after it; the longest has {frames}")]
    NoWindows {
        /// Frames in an action primitive.
        length: usize,
        /// Frames of the longest file at the rate of the model.
        frames: usize,
    },
    /// Motion that is too little or too still.
    #[error("the motion cannot be learned: {0}")]
    Learning(sinew_dynamics::Error),
    /// What was learned would be refused when it is read.
    #[error("the motion gives no model: {0}")]
    Unwritable(ModelFileError),
    /// A file that is no motion model.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// A recording of one frame at the rate of the model.
    #[error("file {}: {rows} frame at the rate of the model; at least 2 are needed", index + 1)]
    ShortSequence {
        /// Number of the file, from 0 on.
        index: usize,
        /// Frames.
        rows: usize,
    },
    /// More files than rows for them.
    #[error("{most} rows are too few for the {files} files; each needs at least 2")]
    TooManySequences {
        /// Files.
        files: usize,
        /// Rows allowed.
        most: usize,
    },
    /// Motion that changes in fewer ways than a latent has coordinates.
    #[error("principal components of the motion: {found}; a latent of {wanted} coordinates needs as many as it has")]
    FewComponents {
        /// Components found.
        found: usize,
        /// Coordinates of a latent.
        wanted: usize,
    },
    /// A limb that keeps still.
    #[error("nothing moves in `{limb}`")]
    StillLimb {
        /// Its name.
        limb: &'static str,
    },
    /// Motion from which no latent model can be learned.
    #[error("the motion cannot be learned: {0}")]
    Latent(sinew_latent::Error),
    /// A latent model that would be refused when it is read.
    #[error("the motion gives no model: {0}")]
    UnwritableLatent(LatentFileError),
    /// A file that is no latent model.
    #[error(transparent)]
    LatentModel(#[from] LatentFileError),
}
