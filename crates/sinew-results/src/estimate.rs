//! What a tracker says about one frame, and what a run says about itself.
//!
//! The seam between tracking and everything that is written.
//!
//! Plain values in SI units: radians, metres, seconds, in the world frame (right-handed, z up). Vectors have one entry per degree of freedom, point or camera in
//! the order of [`RunInfo`]. What a method does not have is `None`, never a number in its place.

pub mod diagnostics;

use sinew_angles::{AngleMarginal, AngleZero, JointAngles};
use sinew_body::KinematicTree;
use sinew_core::transition::Moments;
use sinew_dynamics::primitives::switching::Branch;
use sinew_input::world_turn::WorldTurn;
use sinew_observe::Camera;
use sinew_setup::lasting_sources::PointSources;

/// Whether an estimate uses the frames up to its own, some more, or all of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EstimateKind {
    /// Frames up to this one; draws of different frames are unrelated.
    #[default]
    Filtered,
    /// A number of frames after this one, too.
    FixedLag,
    /// All frames; one draw is one trajectory.
    Smoothed,
}

impl EstimateKind {
    /// Name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Filtered => "filtered",
            Self::FixedLag => "fixed-lag",
            Self::Smoothed => "smoothed",
        }
    }
}

/// How far a frame can be trusted; the number stands in the files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Quality {
    /// No observation in any camera: the estimate comes from the motion model only.
    Predicted = 0,
    /// Seen by one camera: depth comes from the motion model.
    OneCamera = 1,
    /// Seen by at least two cameras.
    #[default]
    Good = 2,
}

/// Marginal of a point, world frame, metres, by axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointMarginal {
    /// Mean.
    pub mean: [f64; 3],
    /// Standard deviation.
    pub sd: [f64; 3],
    /// Standard deviation within the run: without the shift of the world that all points share in all frames.
    pub sd_within: [f64; 3],
    /// 5 % quantile.
    pub q05: [f64; 3],
    /// 95 % quantile.
    pub q95: [f64; 3],
}

/// Marginal of a degree of freedom, radians or metres; angles are continuous within a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StateMarginal {
    /// Mean.
    pub mean: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// 95 % quantile.
    pub q95: f64,
}

/// Statistics that come with each draw of a Hamiltonian sampler; one entry per draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HmcStatistics {
    /// Acceptance probability of the trajectory that ended in the draw.
    pub acceptance_rate: Vec<f64>,
    /// Step size of that trajectory.
    pub step_size: Vec<f64>,
    /// Its number of leapfrog steps.
    pub n_steps: Vec<u32>,
    /// Whether its energy error was too large.
    pub diverging: Vec<bool>,
    /// Energy at its end.
    pub energy: Vec<f64>,
}

/// Thinned draws of equal weight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Draws {
    /// States, one after the other.
    pub states: Vec<f64>,
    /// By how much the points of the body of each lie from where [`RunInfo::body`] has them in that state, three numbers a point, metres; empty where they do not.
    pub shape: Vec<f64>,
    /// Where the detectors see the keypoints of each in space, metres; empty where that is not known apart from the body's points.
    pub detected: Vec<f64>,
    /// Size of the body in each, as a multiple of [`RunInfo::body`]; empty where the size is known.
    pub size: Vec<f64>,
    /// Log posterior density of each, up to a constant of the frame.
    pub lp: Vec<f64>,
    /// For Hamiltonian samplers.
    pub hmc: Option<HmcStatistics>,
}

/// What a weighted set of particles adds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleStatistics {
    /// Normalised log weight of every particle before resampling.
    pub log_weight: Vec<f64>,
    /// Whether the frame ended with a resampling.
    pub resampled: bool,
}

/// A way in which particles moved a part of the body in a frame, with the share of the particles that has it after the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActionShare {
    /// The part, as a place in [`RunInfo::acting_parts`].
    pub part: usize,
    /// Cluster that its motion was matched with; none while there are too few estimates, and for parts without action primitives.
    pub cluster: Option<usize>,
    /// Model that moved it.
    pub model: Branch,
    /// Share of the particles, above 0, at most 1.
    pub share: f64,
}

/// What a tracker says about one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameEstimate {
    /// Number in the names of the keypoint files.
    pub number: u64,
    /// That number over the frame rate, seconds.
    pub time_s: f64,
    /// Whether any camera saw the person.
    pub observed: bool,
    /// Whether tracking was restarted here: the prior of this frame does not come from the frame before.
    pub restarted: bool,
    /// How far the frame can be trusted.
    pub quality: Quality,
    /// Mean state.
    pub mean_state: Vec<f64>,
    /// By how much the draws of what is constant move the filtered state, dimension × draws, row after row; empty without such draws.
    pub moves: Vec<f64>,
    /// Moments of the filtered state before what is constant moves it, as a backward pass takes them.
    pub filtered: Moments,
    /// Marginals of the points.
    pub points: Vec<PointMarginal>,
    /// Marginals of the keypoints as the detectors see them, in the order of [`RunInfo::keypoints`]; none where that is not known apart from the points.
    pub keypoints: Vec<PointMarginal>,
    /// Marginals of the degrees of freedom.
    pub state: Vec<StateMarginal>,
    /// Marginals of the angles of joints, in the order of [`RunInfo::angles`].
    pub angles: Vec<AngleMarginal>,
    /// Thinned draws, as many in each frame.
    pub draws: Draws,
    /// For particle methods.
    pub particles: Option<ParticleStatistics>,
    /// For methods that move parts by action primitives, part by part.
    pub actions: Vec<ActionShare>,
    /// Effective sample size.
    pub ess: f64,
    /// Log evidence of the frame given those before, where the method estimates it.
    pub log_evidence: Option<f64>,
    /// Split R-hat, the largest over the degrees of freedom.
    pub r_hat: Option<f64>,
    /// E-BFMI, the mean over the chains.
    pub energy_fraction: Option<f64>,
    /// Mean acceptance probability.
    pub acceptance: Option<f64>,
    /// Share of the particles whose latent is where the model of poses knows next to nothing, for methods that count them.
    pub off_manifold: Option<f64>,
    /// Divergent trajectories.
    pub divergences: u64,
    /// Trajectories in all.
    pub trajectories: u64,
    /// What was seen, camera by camera, keypoint by keypoint in the order of [`RunInfo::keypoints`]: pixel and confidence, NaN where it is missing.
    pub seen: Vec<[f64; 3]>,
    /// Scatter per axis of the keypoints about the mean pose's projection, robust against outliers, per camera that saw the person.
    pub residual_px: Vec<Option<f64>>,
}

/// Which statistics every frame of a run brings; what is left out here is left out of the files.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Carried {
    /// Log posterior density of each draw.
    pub lp: bool,
    /// [`HmcStatistics`].
    pub hmc: bool,
    /// Log evidence.
    pub log_evidence: bool,
    /// Number of particles, with [`ParticleStatistics`].
    pub particles: Option<usize>,
    /// Size of each draw.
    pub size: bool,
    /// Where the detectors see the keypoints of each draw.
    pub detected: bool,
}

/// What is the same for all frames of a run.
#[derive(Clone, Debug)]
pub struct RunInfo {
    /// Name of the method, for example `hmc`.
    pub method: String,
    /// Whether its draws are weighted particles of a posterior.
    pub is_weighted: bool,
    /// Filtered, smoothed, or between.
    pub kind: EstimateKind,
    /// Body in its fitted size; points and degrees of freedom are in its order.
    pub body: KinematicTree,
    /// The angles of joints that each frame brings.
    pub angles: JointAngles,
    /// What a standing trial takes off them.
    pub zero: Option<AngleZero>,
    /// How the calibration's world was turned, if it was.
    pub world: Option<WorldTurn>,
    /// Frames per second.
    pub fps: f64,
    /// First frame that will be appended.
    pub first_frame: u64,
    /// Draws of each frame.
    pub draws: usize,
    /// Statistics of each frame.
    pub carried: Carried,
    /// Parts of the body whose actions each frame brings; none where the method has no action primitives.
    pub acting_parts: Vec<String>,
    /// Seed of all random streams.
    pub seed: u64,
    /// Instruction set in use.
    pub isa: String,
    /// Cameras in use.
    pub cameras: Vec<Camera>,
    /// Keypoints that are points of the body.
    pub keypoints: Vec<String>,
    /// Whether masks show the solids of the body.
    pub has_masks: bool,
    /// Constant offset (observed minus projected) of each camera, pixels.
    pub camera_offset_px: Vec<[f64; 2]>,
    /// Noise of a keypoint, pixels, that residuals are to be compared with.
    pub sigma_px: f64,
    /// What the uncertainty of the points comes from that is constant; empty where that is not known.
    pub sources: Vec<PointSources>,
    /// The value of the set-up pass, as `setup.toml` holds it.
    pub setup_toml: String,
}
