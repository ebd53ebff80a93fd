//! Guided particle filter: every particle moves with the observation in view (Doucet, Godsill & Andrieu 2000).
//!
//! In the comparison of Choo & Fleet (2001) its opponent is the filter that moves blindly ([`crate::bootstrap`]). For each frame t, with N particles:
//!
//! 1. ancestors = resample(W_{t−1}), by default systematic, where N_eff is at most half of N
//! 2. m, A = mode and Gauss–Newton matrix of p(z_t | x) p(x | x̄), with the estimate x̄ of frame t − 1; P = (Q⁻¹ + A)⁻¹ (the Laplace approximation of the HMC filter, for one step from x̄)
//! 3. s_i ~ q_i, about m + P Q⁻¹ (s_ancestor(i) − x̄), with the matrix P and Gaussian or Student tails ([`sinew_samplers::guided`])
//! 4. W ∝ W_before p(z_t | s_i) p(s_i | s_ancestor(i)) / q_i(s_i), W_before = 1/N after resampling
//! 5. estimate = Σ W_i s_i, N_eff = 1 / Σ W_i², log evidence of the frame = log Σ W_before w_i
//!
//! In the first frame the prior about the start takes the place of the step. The evidence is unbiased on the natural scale. N likelihood evaluations a frame. An effective number below ten says that N is too small; one mode is searched for, and another is found by no particle.

use crate::error::check_dimension;
use crate::particle_state::{ParticleState, are_few};
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::density::{GaussNewton, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::{Cloud, FramePrior, Moments, MotionModel, Predict, Transition};
use sinew_samplers::guided::Guide;
use sinew_samplers::importance::Tails;
use sinew_samplers::laplace::laplace;
use sinew_samplers::particles::{propose_and_reweight, resample_in_room, retreat};
use sinew_samplers::resample::{Ancestors, Scheme};

/// Settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N.
    pub particles: usize,
    /// Resampling scheme.
    pub scheme: Scheme,
    /// The particles are resampled where N_eff / N is at most this.
    pub resample_below: f64,
    /// Tails of the proposals.
    pub tails: Tails,
    /// Prior draws for the place where the search for the mode starts.
    pub search_draws: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            particles: 2000,
            scheme: Scheme::Systematic,
            resample_below: 0.5,
            tails: Tails::StudentT { degrees: 30 },
            search_draws: 64,
        }
    }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Guided<T> {
    config: Config,
    state: ParticleState<T>,
    isa: Isa,
}

impl<T: Transition + Predict> Guided<T> {
    /// A filter that starts around `centre`.
    ///
    /// # Errors
    /// [`Error::Config`], [`Error::Dimension`], or no particles.
    pub fn new(config: Config, transition: T, centre: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        if !(0.0..=1.0).contains(&config.resample_below) {
            let (name, value) = ("resample_below", config.resample_below);
            return Err(Error::Config { name, value, expected: "must be between 0 and 1" });
        }
        config.tails.check()?;
        let state = ParticleState::new(transition, centre, config.particles)?;
        Ok(Self { config, state, isa })
    }

    /// Density of one step from the last estimate; in the first frame, the prior.
    fn step_prior(&self) -> Result<T::Prior, Error> {
        let ParticleState { motion, estimate, started, .. } = &self.state;
        let d = estimate.len();
        let prior = if *started {
            let last: Vec<Block> = estimate.iter().map(|&x| Block::splat(x)).collect();
            let moments = Moments { mean: estimate.clone(), covariance: vec![0.0; d * d] };
            motion.predict(Cloud { last: &last, count: 1, moments: &moments })
        } else {
            motion.initial(estimate)
        };
        prior.map_err(|e| Error::Prior(Box::new(e)))
    }
}

/// Adds the log densities of eight steps to a block.
fn add_steps(motion: &impl Transition, from: &[Block], to: &[Block], log_density: &mut Block) {
    let mut states = vec![0.0; 2 * from.len()];
    let (previous, next) = states.split_at_mut(from.len());
    for lane in 0..LANES {
        for (j, (from, to)) in from.iter().zip(to).enumerate() {
            (previous[j], next[j]) = (from.0[lane], to.0[lane]);
        }
        log_density.0[lane] += motion.log_density(previous, next);
    }
}

/// Step 3 and 4.
fn advance<T: Transition, O: LogDensity + ?Sized>(
    state: &mut ParticleState<T>,
    ancestors: Option<Ancestors>,
    guide: &Guide,
    (observed, prior): (&O, &impl FramePrior),
    to_move: &Stage,
) -> Result<f64, Error> {
    let ParticleState { motion, particles, started, .. } = state;
    let workspace = observed.workspace().max(prior.workspace());
    let proposed = |block: usize, from: &[Block], to: &mut [Block], ws: &mut [Block]| {
        let log_proposal = guide.sample_block(from, to, &mut to_move.block(block as u32));
        let mut log_weight = observed.log_density_block(to, ws);
        if *started {
            add_steps(motion, from, to, &mut log_weight);
        } else {
            let prior = prior.log_density_block(to, ws);
            log_weight.0.iter_mut().zip(prior.0).for_each(|(w, p)| *w += p);
        }
        log_weight.0.iter_mut().zip(log_proposal.0).for_each(|(w, q)| *w -= q);
        log_weight
    };
    let weighed = propose_and_reweight(particles, ancestors, workspace, proposed);
    weighed.map_err(|error| {
        retreat(particles);
        error.into()
    })
}

impl<T: Transition + Predict + Send, O: GaussNewton + ?Sized> Tracker<O> for Guided<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.state.estimate.len())?;
        let [to_resample, to_search, to_move] = stage.split(["resample", "search", "move"]);
        let prior = self.step_prior()?;
        let Config { scheme, resample_below, tails, search_draws, .. } = self.config;
        let laplace = laplace(observed, &prior, search_draws, self.isa, to_search)?;
        let guide = Guide::new(laplace, &prior.precision(), self.state.estimate.clone(), tails, self.isa)?;
        let particles = &mut self.state.particles;
        let resampled = self.state.started && are_few(particles, resample_below);
        let ancestors = resampled.then(|| resample_in_room(particles, scheme, to_resample));
        let log_evidence = advance(&mut self.state, ancestors, &guide, (observed, &prior), &to_move)?;
        Ok(self.state.weighed(log_evidence, resampled))
    }
}

impl<T: MotionModel> Inferred for Guided<T> {
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior()
    }

    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl<T: MotionModel> Resume for Guided<T> {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)
    }
}
