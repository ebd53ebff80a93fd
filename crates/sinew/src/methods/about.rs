//! What a method is: its description, and how a tracker is made of it.

use super::score::Score;
use crate::Error;
use crate::config::common::{LATENT, MOTION_MODEL};
use crate::config::setting::{AnySetting, SettingValues};
use crate::setup::Setup;
use crate::track::error::TrackError;
use sinew_core::lanes::Isa;
use sinew_core::part::PartTree;
use sinew_core::random::Stage;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::random_walk::RandomWalk;
use sinew_latent::file::StoredModel;
use sinew_observe::frame_likelihood::FrameLikelihood;
use sinew_tracking::{Resume, Tracker};
use std::fmt;
use std::sync::Arc;

/// What the draws of a method are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gives {
    /// Draws of the posterior by Markov chains.
    Chains,
    /// Draws of the posterior by weighted particles.
    Particles,
    /// What survives a search for a peak: no posterior.
    Search,
}

/// Whether a method tracks in the latent space of a learned model of poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LatentUse {
    /// It never does.
    No,
    /// Where a model is given.
    Taken,
    /// Always.
    Needed,
}

/// The description of a method.
#[derive(Clone, Debug)]
pub struct About {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// One line of help.
    pub help: &'static str,
    /// What its draws are.
    pub gives: Gives,
    /// Whether it needs gradients of the likelihood. Images are then compared by the distance of limbs from contours. That says nothing of pixels that no limb covers, so keypoints are needed, too.
    pub needs_gradients: bool,
    /// Whether it takes the body part by part.
    pub needs_parts: bool,
    /// Whether it tracks in the latent space of a learned model.
    pub latent: LatentUse,
    /// Weighting function of images where nobody names one: the paper's, but for filters, which lose arms in the silhouette of the torso unless uncovered pixels count, too.
    pub score: Score,
    /// The same where keypoints are observed, too.
    pub score_beside_keypoints: Score,
    /// Number of particles where nobody says how many; `None` for methods without particles.
    pub particles: Option<fn() -> usize>,
    /// Settings that no other method has; idle with every other method ([`crate::config::idle`]).
    pub settings: &'static [&'static dyn AnySetting],
    /// The method with the settings of a run.
    pub configure: fn(&SettingValues) -> Arc<dyn Method>,
    /// A mistake that shows only in several settings together, as a sentence; `None` where there is none.
    pub mistake: fn(&SettingValues) -> Option<String>,
}

impl About {
    /// The method with its default settings.
    #[must_use]
    pub fn usual(&self) -> Arc<dyn Method> {
        (self.configure)(&SettingValues::default())
    }
}

/// That a method takes no learned motion model, where one is given.
#[must_use]
pub fn no_motion_model(values: &SettingValues, method: &str) -> Option<String> {
    values.of(&MOTION_MODEL).map(|_| {
        format!(
            "`motion_model` cannot be used with `{method}`; it is for the methods hmc, bootstrap, guided, annealed and hppf"
        )
    })
}

/// That a method needs a latent model, where none is given.
#[must_use]
pub fn no_latent_model(values: &SettingValues, method: &str) -> Option<String> {
    let missing = values.of(&LATENT).is_none();
    missing.then(|| {
        format!("`{method}` needs `latent`, the file of a latent model of the body; `sinew learn latent` makes one")
    })
}

/// What a tracker is made of besides the settings of its method.
pub struct Making<'a> {
    /// The set-up of the recording.
    pub setup: &'a Setup,
    /// The motion prior.
    pub transition: &'a MotionPrior,
    /// The parts of the body, for methods that need them.
    pub parts: Option<&'a PartTree>,
    /// Action primitives of the body, where the run has a motion model.
    pub motion_model: Option<&'a PrimitiveModel>,
    /// Latent model of the body's poses, where the run has one.
    pub latent: Option<&'a StoredModel>,
    /// Points of the body that keypoints show, by name.
    pub keypoints: &'a [String],
    /// Time between frames, seconds.
    pub dt: f64,
    /// Instruction set.
    pub isa: Isa,
}

impl Making<'_> {
    /// The motion prior of methods that take the body part by part or in steps of one width: a random walk.
    ///
    /// # Errors
    /// [`TrackError::NoMotionModel`] where it was learned.
    pub fn walk(&self, method: &About) -> Result<RandomWalk, Error> {
        Ok(self.transition.walk().cloned().ok_or(TrackError::NoMotionModel { method: method.name })?)
    }

    /// The parts of the body.
    ///
    /// # Errors
    /// [`TrackError::NoParts`].
    pub fn parts(&self) -> Result<PartTree, Error> {
        Ok(self.parts.cloned().ok_or(TrackError::NoParts)?)
    }
}

/// Step size and trajectory length of Hamiltonian Monte Carlo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepSize {
    /// In units of the metric.
    pub step_size: f64,
    /// Leapfrog steps of a trajectory.
    pub leapfrog_steps: usize,
}

/// A tracker on the likelihoods of frames that can be saved and restored.
pub trait Steps: Tracker<FrameLikelihood> + Resume {}

impl<T: Tracker<FrameLikelihood> + Resume> Steps for T {}

/// A method with its settings.
pub trait Method: fmt::Debug + Send + Sync {
    /// Its description.
    fn about(&self) -> &'static About;

    /// Number of weighted draws of a frame, for methods with weights.
    fn weighted_draws(&self) -> Option<usize>;

    /// A tracker that starts at a state.
    ///
    /// # Errors
    /// Settings, a transition or a start that the tracker refuses.
    fn tracker(&self, making: &Making<'_>, start: Vec<f64>) -> Result<Box<dyn Steps>, Error>;

    /// Whether its steps say by which action primitives the parts of the body moved.
    fn gives_actions(&self, making: &Making<'_>) -> bool {
        let _ = making;
        false
    }

    /// Whether limits of joints are in its prior.
    fn limits_joints(&self) -> bool {
        false
    }

    /// What a user of the method should know of how it was made, a sentence each.
    fn remarks(&self, making: &Making<'_>) -> Vec<String> {
        let _ = making;
        vec![]
    }

    /// Step size and trajectory length for a recording, from one of its frames; `None` for methods without.
    ///
    /// # Errors
    /// No step size found.
    fn tuned(
        &self,
        making: &Making<'_>,
        start: Vec<f64>,
        observed: &FrameLikelihood,
        stage: Stage,
    ) -> Result<Option<StepSize>, Error> {
        let _ = (making, start, observed, stage);
        Ok(None)
    }
}
