//! What tracking refuses of a set-up, a body and a machine.

use sinew_dynamics::model_file::ModelFormat;
use sinew_dynamics::primitives::file::ModelFileError;
use sinew_latent::file::LatentFileError;
use std::path::PathBuf;

/// A recording that cannot be tracked as it stands, or numbers that fail.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrackError {
    /// A camera that the set-up lacks.
    #[error("the set-up knows no camera `{camera}`; it has {}", known.join(", "))]
    UnknownCamera {
        /// The camera.
        camera: String,
        /// Cameras of the set-up.
        known: Vec<String>,
    },
    /// A layout that shares too few points with the body.
    #[error("layout `{layout}` and the body share {shared} points; {least} are needed")]
    FewPoints {
        /// Name of the layout.
        layout: String,
        /// Points of both.
        shared: usize,
        /// Points that are needed.
        least: usize,
    },
    /// A set-up of another body.
    #[error("the set-up's start pose has {found} numbers, the body {dof} degrees of freedom")]
    StartPose {
        /// Numbers of the pose.
        found: usize,
        /// Degrees of freedom of the body.
        dof: usize,
    },
    /// A frame whose number no random stream has.
    #[error("frame number {number} is above {}", u32::MAX)]
    FrameNumber {
        /// The number.
        number: u64,
    },
    /// Solids that are no partition of the state.
    #[error("the solids of the body are no parts of its state: {0}")]
    Parts(#[source] sinew_core::Error),
    /// Solids that do not fit the body.
    #[error(transparent)]
    Solids(sinew_body::Error),
    /// A body without parts, for a method that takes it part by part.
    #[error("the body has no parts")]
    NoParts,
    /// Another axis that points up than that of the set-up.
    #[error("`{setting}` is {asked}; the set-up was made with {known}")]
    UpAxis {
        /// The setting that was given.
        setting: &'static str,
        /// Its value.
        asked: String,
        /// That of the set-up.
        known: String,
    },
    /// An axis and a direction that point up.
    #[error("`up` and `up_axis` are both given; each says what points up")]
    UpTwice,
    /// Another body than that of the set-up.
    #[error("`body` is {asked}; the set-up was made with {known}")]
    Body {
        /// The setting.
        asked: String,
        /// That of the set-up.
        known: String,
    },
    /// A file that is no set-up.
    #[error("{}:{line}: {problem}", path.display())]
    SetupFile {
        /// The file.
        path: PathBuf,
        /// Line from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// An instruction set that the processor lacks.
    #[error("this processor has no `{asked}`; it has {}", available.join(", "))]
    NoInstructionSet {
        /// The setting.
        asked: String,
        /// Instruction sets of the processor.
        available: Vec<&'static str>,
    },
    /// Settings of a stopped run that are not JSON.
    #[error("the settings of the run cannot be read: {0}")]
    StoredSettings(#[source] serde_json::Error),
    /// A value that a checkpoint cannot hold.
    #[error("the checkpoint cannot be encoded: {0}")]
    Encoding(#[source] postcard::Error),
    /// A file that is no motion model.
    #[error(transparent)]
    MotionModel(ModelFileError),
    /// A file that is no latent model.
    #[error(transparent)]
    LatentModel(LatentFileError),
    /// A model of another body.
    #[error("the {} was learned for the body {learned}, which is not the one that is tracked", format.what)]
    ModelBody {
        /// What kind of model.
        format: ModelFormat,
        /// Body of the model.
        learned: String,
    },
    /// A model of another frame rate.
    #[error("the {} was learned at {learned} frames per second; the recording has {tracked}", format.what)]
    ModelRate {
        /// What kind of model.
        format: ModelFormat,
        /// Rate of the model.
        learned: f64,
        /// Rate of the recording.
        tracked: f64,
    },
    /// A learned motion model for a method that takes none.
    #[error("`{method}` takes no motion model")]
    NoMotionModel {
        /// Name of the method.
        method: &'static str,
    },
    /// A method in a latent space without a model of one.
    #[error("`{method}` needs a latent model")]
    NoLatentModel {
        /// Name of the method.
        method: &'static str,
    },
    /// A latent model that leaves out coordinates of the pose, for a method that needs them all.
    #[error("`{method}` needs a latent model of the whole pose; this one of {body} leaves out its feet")]
    LatentRest {
        /// Name of the method.
        method: &'static str,
        /// Name of the body.
        body: String,
    },
    /// A latent model that cannot be tracked in.
    #[error(transparent)]
    Latent(#[from] sinew_latent::Error),
    /// A sampler that refuses its settings or fails.
    #[error(transparent)]
    Sampler(#[from] sinew_samplers::Error),
    /// A motion prior that does not exist.
    #[error(transparent)]
    Motion(#[from] sinew_dynamics::Error),
}
