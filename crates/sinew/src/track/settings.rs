//! How a recording is tracked.

use super::method::Method;
use sinew_core::lanes::Isa;
use sinew_dynamics::random_walk::Between;
use sinew_observe::Noise;
use sinew_observe::image_score::ImageScore;
use sinew_samplers::annealed_search;

/// How to track; the default is the preset for real recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// The tracker.
    pub method: Method,
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
    /// Chains of `hmc`.
    pub chains: usize,
    /// Updates of each chain in a frame.
    pub updates: usize,
    /// First samples of each chain that are discarded.
    pub burn_in: usize,
    /// Jitter of the step size.
    pub jitter: f64,
    /// Particles; those of `coarse-to-fine` at its coarse level.
    pub particles: usize,
    /// Layers of `annealed`.
    pub layers: annealed_search::Config,
    /// Particles of the fine level of `coarse-to-fine`.
    pub fine: usize,
    /// Weighting function of images.
    pub score: ImageScore,
    /// Longest side of the raster in which silhouettes are compared, pixels.
    pub raster: usize,
    /// Thinned draws kept of each frame.
    pub draws: usize,
    /// Whether the set-up is that of an earlier run, which advice depends on.
    pub setup_is_given: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            method: Method::Hmc,
            seed: 1,
            fps: 30.0,
            isa: Isa::best(),
            noise: Noise::OutlierFloor { outlier: 0.02 },
            least_confidence: 0.1,
            between: Between::Gaussian,
            motion_scale: 1.0,
            chains: 16,
            updates: 32,
            burn_in: 8,
            jitter: 0.2,
            particles: Method::default().usual_particles(),
            layers: annealed_search::Config { layers: 5, crossover: 0.5, ..annealed_search::Config::default() },
            fine: 500,
            score: Method::default().usual_score().with_kappa(100.0),
            raster: 320,
            draws: 64,
            setup_is_given: false,
        }
    }
}
