//! How a recording is tracked.

use crate::methods::{Method, Score, hmc};
use sinew_angles::Convention;
use sinew_core::lanes::Isa;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::random_walk::Between;
use sinew_latent::file::StoredModel;
use sinew_observe::Noise;
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_results::standing_trial::StandingTrial;
use std::sync::Arc;

/// How to track; the default is the preset for real recordings.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The method with its own settings.
    pub method: Arc<dyn Method>,
    /// Seed of all random streams.
    pub seed: u64,
    /// Frames per second.
    pub fps: f64,
    /// Instruction set.
    pub isa: Isa,
    /// Density of a keypoint.
    pub noise: Noise,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Prior between frames.
    pub between: Between,
    /// Factor on the motion noise that the set-up pass found.
    pub motion_scale: f64,
    /// Learned motion model that takes the place of the random walk.
    pub motion_model: Option<Arc<PrimitiveModel>>,
    /// Latent model of the body's poses.
    pub latent_model: Option<Arc<StoredModel>>,
    /// Weighting function of images.
    pub score: ImageScore,
    /// Longest side of the raster in which silhouettes are compared, pixels.
    pub raster: usize,
    /// Whose definitions the angles of joints follow.
    pub angles: Convention,
    /// Run of a trial in which the person stands: the zero of the angles.
    pub standing: Option<Arc<StandingTrial>>,
    /// Thinned draws kept of each frame.
    pub draws: usize,
    /// Whether the set-up is that of an earlier run, which advice depends on.
    pub setup_is_given: bool,
    /// Number by which the person was chosen, which advice depends on.
    pub person: Option<usize>,
}

impl Settings {
    /// Whether the colours of pictures are compared: by scores that do, which methods with gradients do not use.
    #[must_use]
    pub fn compares_colours(&self) -> bool {
        self.score.compares_colours() && !self.method.about().needs_gradients
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: (hmc::ABOUT.usual)(),
            seed: 1,
            fps: 30.0,
            isa: Isa::best(),
            noise: Noise::OutlierFloor { outlier: 0.02 },
            least_confidence: 0.1,
            between: Between::Gaussian,
            motion_scale: 1.0,
            motion_model: None,
            latent_model: None,
            score: Score::Bidirectional.with_kappa(100.0),
            raster: 320,
            angles: Convention::default(),
            standing: None,
            draws: 64,
            setup_is_given: false,
            person: None,
        }
    }
}
