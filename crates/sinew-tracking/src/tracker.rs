//! What every tracker is: a step from one frame's observation to the posterior of the state, and what it believes then.

use crate::Error;
use crate::posterior::Posterior;
use sinew_core::random::Stage;

/// What is believed of the state: the posterior of the last frame.
pub trait Inferred {
    /// Draws of the last frame's posterior; before the first step they mean nothing.
    fn posterior(&self) -> Posterior<'_>;

    /// Best known state: [`StepInfo::mean`] of the last frame, before the first step the start.
    fn estimate(&self) -> &[f64];
}

/// A filter on observations of type `O`, for instance `dyn GaussNewton`. The parameter names what the tracker demands, so a box of trackers offers exactly what all of its members need.
pub trait Tracker<O: ?Sized>: Inferred + Send {
    /// Moves on to a frame and takes in its observation. A frame without observation is a log density of 0 everywhere: the tracker continues on its prior.
    ///
    /// # Errors
    /// Where the frame has no posterior; the tracker then stands where it stood before.
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error>;
}

/// What a diagnostician wants to know of one step of any tracker.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepInfo {
    /// Mean state of the posterior, or what a search reports in its place.
    pub mean: Vec<f64>,
    /// Effective number of draws: 1 / Σ W² of particles, the least of the parts where they are chosen part by part, the least n / τ over coordinates of chains.
    pub ess: f64,
    /// Estimate of log p(observation | earlier observations). By `hmc` from one importance draw a chain, from the prior or from the Laplace approximation: unbiased on the natural scale, but rough in many dimensions. Searches have none.
    pub log_evidence: Option<f64>,
    /// Whether the tracker was made again before this step, so that it follows from no earlier frame.
    pub restarted: bool,
    /// Mean acceptance probability of trajectories.
    pub acceptance: Option<f64>,
    /// Trajectories made.
    pub trajectories: usize,
    /// Divergent ones among them.
    pub divergences: usize,
    /// Split R̂ over the chains' kept draws, the largest over coordinates.
    pub r_hat: Option<f64>,
    /// E-BFMI, the mean over the chains.
    pub energy_fraction: Option<f64>,
    /// Whether the particles were resampled at the start of the step.
    pub resampled: Option<bool>,
    /// Exponent of the likelihood in each layer of annealing, from broad to peaked.
    pub exponents: Vec<f64>,
    /// Survival diagnostic D = 1 / Σ W² of each layer of annealing, or of each part of a partitioned state.
    pub survivors: Vec<f64>,
    /// For each part, in ascending order, the choices of its motion ([`sinew_core::transition::Choices`]) that moved it, with the share of the particles that have each after all resampling of the frame; without parts nothing.
    pub choices: Vec<Vec<(u32, f64)>>,
    /// Share of the particles whose latent is where the model of poses knows next to nothing; of trackers in a latent space that were given its variance.
    pub off_manifold: Option<f64>,
    /// Evaluations of the observation's log density without gradient.
    pub likelihood_evaluations: usize,
    /// Evaluations of the log likelihood of one part of the observation.
    pub part_evaluations: usize,
    /// Evaluations with gradient; the few of a search for the mode before the chains start are not counted.
    pub gradient_evaluations: usize,
}
