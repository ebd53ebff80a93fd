//! Hybrid Monte Carlo filter (Choo & Fleet 2001).
//!
//! For each frame t, with M chains, R updates, b discarded samples, L leapfrog steps and factor η:
//!
//! 1. prior = the transition's prediction from frame t − 1 (eq. 9, or another: a value of the transition); in the first frame around the given start
//! 2. u_i ~ prior, i = 1 … M, from a mixture one a component; w_i = p(z_t | u_i)
//! 3. s^(i,0) = M draws with replacement from {u_i, w_i}
//! 4. target = p(z_t | s) · prior(s) (eq. 10)
//! 5. h_j = curvature from K prior draws, ε_j = η / √h_j (eq. 17), both frozen for the frame
//!    (with [`Geometry::Dense`], not the paper's, steps 2 and 5 use the Laplace approximation at the mode: u_i are its draws, w_i their importance weights, and its whole matrix the metric)
//! 6. for each chain i and r = 1 … R: s^(i,r) = hybrid Monte Carlo update of s^(i,r−1) (eqs. 13–16)
//!    (with a patience above 1, not the paper's, chains that disagree continue until they have 2, 4, … up to `patience` times the updates; as large a share of them is discarded)
//! 7. estimate = mean of s^(i,r) over all i and r ≥ b; a rejected state counts again
//!
//! Only the last states s^(i,R), and the moments of all kept draws, pass to the next frame, the moments shrunk and then wider by what few draws lose ([`mod@sinew_samplers::few_draws`]); some of these draws themselves where the transition asks for them ([`Predict::wanted_draws`]). M(R + 1 − b) draws, M + M R L evaluations and one gradient a chain to begin with. Chains are moved in blocks of eight lanes: 10 chains cost as much as 16.
//! The chains of one frame start close together, so R̂ within a frame is the sign to look at.
//!
//! An observation that has a gradient and no curvature is given one for step 5 by [`GivenCurvature`](sinew_core::combinators::GivenCurvature), a rough diagonal or zeros:
//!
//! ```
//! use sinew_core::combinators::GivenCurvature;
//! use sinew_core::density::{GradLogDensity, LogDensity};
//! use sinew_core::lanes::Isa;
//! use sinew_core::random::Stage;
//! use sinew_core::transition::diagonal_matrix;
//! use sinew_dynamics::linear_gaussian::LinearGaussian;
//! use sinew_tracking::Tracker;
//! use sinew_tracking::hmc_filter::{Config, HmcFilter};
//!
//! /// A level seen with variance 1/4.
//! struct Seen(f64);
//! impl LogDensity for Seen {
//!     fn dim(&self) -> usize {
//!         1
//!     }
//!     fn log_density(&self, x: &[f64]) -> f64 {
//!         -2.0 * (x[0] - self.0).powi(2)
//!     }
//! }
//! impl GradLogDensity for Seen {
//!     fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
//!         grad[0] = -4.0 * (x[0] - self.0);
//!         self.log_density(x)
//!     }
//! }
//! let one = diagonal_matrix(&[1.0]);
//! let walk = LinearGaussian::new(1, one.clone(), one.clone(), one, Isa::best())?;
//! let mut filter = HmcFilter::new(Config { updates: 200, ..Config::default() }, walk, vec![0.0], Isa::best())?;
//! let observed = GivenCurvature { target: &Seen(1.0), diagonal: vec![4.0] };
//! let info = filter.step(&observed, Stage::new(1, "example"))?;
//! // N(0, 1) and N(1, 1/4) have the product N(0.8, 0.2).
//! assert!((info.mean[0] - 0.8).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::handed::Handed;
use crate::posterior::Posterior;
use crate::resume::check_length;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Sum;
use sinew_core::density::GaussNewton;
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::transition::{Cloud, FramePrior, Moments, Predict, diagonal_matrix};
use sinew_samplers::chains::{ChainDraws, ChainQuality, ChainRun, Schedule};
use sinew_samplers::curvature::curvature;
use sinew_samplers::few_draws::widen;
use sinew_samplers::hmc::Hmc;
use sinew_samplers::laplace::laplace;
use sinew_samplers::metric::{Geometry, Metric};
use sinew_samplers::moments;
use sinew_samplers::starts::{importance_starts, laplace_starts};
use sinew_samplers::tuning::{self, StepSizeTrial, Tuned};

/// Split R̂ above which the chains of a frame disagree.
pub const R_HAT_BOUND: f64 = 1.05;

/// Settings; the default is the paper's 28-dimensional one, with η in units of our curvature.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Chains M.
    pub chains: usize,
    /// Updates R of each chain.
    pub updates: usize,
    /// Samples b of each chain to discard, the start included.
    pub burn_in: usize,
    /// Factor η of the component steps.
    pub step_size: f64,
    /// Leapfrog steps L of a trajectory.
    pub leapfrog_steps: usize,
    /// Steps are multiplied by a number uniform in 1 ± jitter, one a trajectory.
    pub jitter: f64,
    /// Prior draws K for the curvature.
    pub curvature_draws: usize,
    /// While the split R̂ of a frame is above [`R_HAT_BOUND`], or does not exist since no chain moved, its chains continue until they have twice the updates and discarded samples, and again, up to this multiple; 1 (the paper's) never.
    pub patience: usize,
    /// Start and metric of the trajectories: the paper's, or the Laplace approximation's.
    pub geometry: Geometry,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            chains: 10,
            updates: 32,
            burn_in: 6,
            step_size: 0.35,
            leapfrog_steps: 40,
            jitter: 0.0,
            curvature_draws: 64,
            patience: 1,
            geometry: Geometry::Diagonal,
        }
    }
}

impl Config {
    /// For real recordings, not the paper's: 16 chains (what 10 cost), jitter, a dense metric and patience; to be used with a Gaussian prior between frames.
    #[must_use]
    pub fn real_recordings() -> Self {
        Self {
            chains: 16,
            step_size: 0.5,
            leapfrog_steps: 5,
            burn_in: 8,
            jitter: 0.2,
            patience: 4,
            geometry: Geometry::Dense,
            ..Self::default()
        }
    }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct HmcFilter<T> {
    config: Config,
    transition: T,
    isa: Isa,
    estimate: Vec<f64>,
    draws: ChainDraws,
    weights: Vec<f64>,
    effective: f64,
    handed: Handed,
    /// Moments for the next prior, and the number of frames that led to them.
    handed_moments: Option<(Moments, usize)>,
}

/// What a frame's chains start with.
struct Start<P> {
    prior: P,
    states: Vec<Block>,
    metric: Metric,
    log_evidence: f64,
}

impl<T: Predict> HmcFilter<T> {
    /// A filter that starts around `centre`.
    ///
    /// # Errors
    /// [`Error::Config`] or [`Error::Dimension`].
    pub fn new(config: Config, transition: T, centre: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        let (found, expected) = (centre.len(), transition.dim());
        if found != expected {
            return Err(Error::Dimension { name: "start", found, expected });
        }
        Hmc::new(config.step_size, &[1.0], config.leapfrog_steps, config.jitter, isa)?;
        for (name, value, least) in [
            ("chains", config.chains, 1),
            ("updates", config.updates, config.burn_in.max(1)),
            ("patience", config.patience, 1),
        ] {
            if value < least {
                let expected = "must be at least 1, and updates at least burn_in";
                return Err(Error::Config { name, value: value as f64, expected });
            }
        }
        let draws = ChainDraws { dim: expected, ..ChainDraws::default() };
        Ok(Self {
            config,
            transition,
            isa,
            estimate: centre,
            draws,
            weights: vec![],
            effective: 0.0,
            handed: Handed::default(),
            handed_moments: None,
        })
    }

    /// The prior of the coming frame.
    pub(crate) fn prior(&self) -> Result<T::Prior, Error> {
        let prior = match &self.handed_moments {
            None => self.transition.initial(&self.estimate),
            Some((moments, _)) => {
                let Handed { states, count } = &self.handed;
                self.transition.predict(Cloud { last: states, count: *count, moments })
            }
        };
        prior.map_err(|e| Error::Prior(Box::new(e)))
    }

    /// Steps 1–3 and 5: prior, starting states, curvature.
    fn start<O: GaussNewton + ?Sized>(&self, observed: &O, stage: Stage) -> Result<Start<T::Prior>, Error> {
        let (d, chains) = (self.transition.dim(), self.config.chains);
        if observed.dim() != d {
            return Err(Error::Dimension { name: "observation", found: observed.dim(), expected: d });
        }
        let prior = self.prior()?;
        let [to_start, to_average] = stage.split(["start", "curvature"]);
        let draws = self.config.curvature_draws;
        let (states, log_evidence, metric) = match self.config.geometry {
            Geometry::Diagonal => {
                let (states, log_evidence) = importance_starts(observed, &prior, chains, to_start)?;
                (states, log_evidence, Metric::Diagonal(curvature(observed, &prior, draws, to_average)))
            }
            Geometry::Dense => {
                let laplace = laplace(observed, &prior, draws, self.isa, to_average)?;
                let target = Sum(observed, &prior);
                let (states, log_evidence) = laplace_starts(&target, &laplace, chains, self.isa, to_start)?;
                (states, log_evidence, Metric::Dense(laplace.metric))
            }
        };
        Ok(Start { prior, states, metric, log_evidence })
    }

    /// Keeps draws of equal weight, and their mean, and says what they are worth.
    fn keep(&mut self, draws: ChainDraws) -> ChainQuality {
        let count = draws.stats.len();
        self.weights.clear();
        self.weights.resize(count, 1.0 / count as f64);
        self.estimate = moments::mean(&draws.states, draws.dim, &self.weights);
        self.draws = draws;
        self.draws.quality(&self.estimate)
    }

    fn view(&self) -> Posterior<'_> {
        Posterior {
            dim: self.draws.dim,
            states: &self.draws.states,
            weights: &self.weights,
            effective: self.effective,
            chain_stats: &self.draws.stats,
        }
    }

    /// Step size and length for the coming frame, given its observation; the filter does not move. Use them in the [`Config`] of all frames.
    ///
    /// # Errors
    /// Where the frame has no start or the search no end.
    pub fn tune<O: GaussNewton + ?Sized>(
        &self,
        observed: &O,
        config: &tuning::Config,
        stage: Stage,
    ) -> Result<Tuned, Error> {
        let [to_start, to_tune] = stage.split(["start", "tune"]);
        let Start { prior, states, metric, .. } = self.start(observed, to_start)?;
        let mut trial = StepSizeTrial { target: &Sum(observed, &prior), metric: &metric, states, isa: self.isa };
        Ok(tuning::length(&mut trial, config, &to_tune)?)
    }
}

impl<T: Predict + Send, O: GaussNewton + ?Sized> Tracker<O> for HmcFilter<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let Config { chains, step_size, leapfrog_steps, jitter, curvature_draws, patience, .. } = self.config;
        let before = self.handed_moments.is_some().then(|| self.estimate.clone());
        let schedule = Schedule { updates: self.config.updates, burn_in: self.config.burn_in };
        let [to_start, to_move] = stage.split(["start", "chains"]);
        let Start { prior, states, metric, log_evidence } = self.start(observed, to_start)?;
        let hmc = Hmc::with_metric(step_size, &metric, leapfrog_steps, jitter, self.isa)?;
        let target = Sum(observed, &prior);
        let mut run = ChainRun::new(&target, &hmc, &states, chains, schedule, &to_move)?;
        let mut quality = self.keep(run.draws(schedule.burn_in)?);
        let (mut starts, mut times) = (1, 1);
        while times < patience && (quality.r_hat > R_HAT_BOUND || quality.r_hat.is_nan()) {
            let more = times.min(patience - times);
            run.resume(&target, &hmc, more * schedule.updates, &to_move.round(starts))?;
            (starts, times) = (starts + 1, times + more);
            quality = self.keep(run.draws(times * schedule.burn_in)?);
        }
        let updates = times * schedule.updates;
        self.effective = quality.ess_of_squares;
        let mut moments = self.view().moments(self.isa);
        metric.shrink(&mut moments, self.effective);
        let precision = match self.config.geometry {
            Geometry::Diagonal => diagonal_matrix(prior.precision_diagonal()),
            Geometry::Dense => prior.precision(),
        };
        let frames = self.handed_moments.as_ref().map_or(0, |(_, frames)| *frames) + 1;
        widen(&mut moments, &quality, &metric, &precision, frames);
        self.handed_moments = Some((moments, frames));
        self.handed = Handed::of(&self.draws, chains, self.transition.wanted_draws());
        self.transition.follow(before.as_deref(), &self.estimate);
        Ok(StepInfo {
            mean: self.estimate.clone(),
            ess: quality.ess,
            log_evidence: Some(log_evidence),
            acceptance: Some(self.draws.acceptance),
            trajectories: chains * updates,
            divergences: self.draws.divergences,
            r_hat: Some(quality.r_hat).filter(|r| !r.is_nan()),
            energy_fraction: Some(quality.energy_fraction).filter(|e| e.is_finite()),
            likelihood_evaluations: chains,
            gradient_evaluations: chains * (starts + updates * leapfrog_steps) + curvature_draws,
            ..StepInfo::default()
        })
    }
}

impl<T: Predict> Inferred for HmcFilter<T> {
    fn posterior(&self) -> Posterior<'_> {
        self.view()
    }

    fn estimate(&self) -> &[f64] {
        &self.estimate
    }
}

impl<T: Predict> Resume for HmcFilter<T> {
    fn save(&self) -> Vec<f64> {
        let mut saved = self.estimate.clone();
        if let Some((moments, frames)) = &self.handed_moments {
            saved.push(*frames as f64);
            saved.extend(&moments.mean);
            saved.extend(&moments.covariance);
            self.handed.put(&mut saved, self.transition.wanted_draws());
        }
        saved.extend(self.transition.memory());
        saved
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let d = self.estimate.len();
        let memory = self.transition.memory().len();
        let started = saved.len() > d + memory;
        if !started {
            check_length(saved.len(), d + memory)?;
        }
        let (saved, memory) = saved.split_at(saved.len() - memory);
        let (estimate, rest) = saved.split_at(d);
        if started {
            check_length(saved.len().min(2 * d + 1 + d * d), 2 * d + 1 + d * d)?;
            let (frames, rest) = rest.split_at(1);
            let (mean, rest) = rest.split_at(d);
            let (covariance, handed) = rest.split_at(d * d);
            self.handed = Handed::taken(handed, d, self.config.chains, self.transition.wanted_draws())?;
            let moments = Moments { mean: mean.to_vec(), covariance: covariance.to_vec() };
            self.handed_moments = Some((moments, frames[0] as usize));
        } else {
            self.handed_moments = None;
        }
        self.estimate = estimate.to_vec();
        self.transition.recall(memory);
        Ok(())
    }
}
