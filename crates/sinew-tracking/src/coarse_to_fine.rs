//! Coarse-to-fine particle filter with bottom-up aggregation. A **search**: it reports the best of what it has seen, and no posterior.
//!
//! For each frame, with N coarse and M fine particles, steps δ = diag(δ_i) of a [`Grid`](sinew_samplers::grid), A = 0.2 I, B = δ, and X̂ of the frames before:
//!
//! 1. coarse: ancestors = multinomial(π); s_j = s_ancestor(j) + A (X̂(t) − X̂(t − 1)) + B ω (eq. 2), each coordinate snapped to the centre of its partition
//! 2. π_j ∝ p(Z | s_j) (eq. 3), of equal states once; X_c = s of the largest
//! 3. fine: y_j = X_c + δ ω, j = 1 … M; λ_jk = likelihood of part k of y_j
//! 4. o_k = argmax over all M of λ_jk (printed is the number of coarse particles); X̂(t + 1) = part k of y_(o_k), k = 1 … K, put together
//!
//! The coarse particles with their weights pass to the next frame. Before two estimates exist the difference in step 1 is 0; a coordinate that wraps differs the short way round. The coarse particles start at the given
//! state. At most N + 1 evaluations of the whole likelihood a frame, the one for that of X̂, and M K of parts; with [`Judging::Whole`] M K of the whole.
//!
//! In steps 3 and 4 each part of y_j is judged under the other parts of y_j, which need not be those that are chosen. "The likelihood function (3) is used … for each body part" can be read otherwise: see [`Judging`].

use crate::error::check_dimension;
use crate::particle_state::ParticleState;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::density::PartLogDensity;
use sinew_core::lanes::Isa;
use sinew_core::part::PartTree;
use sinew_core::random::Stage;
use sinew_core::transition::MotionModel;
use sinew_samplers::diffusion::diffuse;
use sinew_samplers::grid::GridAxis;
use sinew_samplers::particles::{Particles, best, resample, temper};
use sinew_samplers::parts::{choose, choose_chained, choose_whole};
use sinew_samplers::quantised::{evaluate_distinct, walk};
use sinew_samplers::resample::Scheme;

/// Settings; the default is the largest of the paper's.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of coarse particles N.
    pub coarse: usize,
    /// Number of fine particles M.
    pub fine: usize,
    /// The part A of the last change of the estimate by which the coarse particles move on.
    pub drift: f64,
    /// Whether coarse particles stand on the centres of partitions.
    pub snapped: bool,
    /// How the parts of the fine particles are judged.
    pub judging: Judging,
}

/// By what the best part k of the fine particles is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judging {
    /// The likelihood of part k on its own particle.
    Decoupled,
    /// From the root outwards, the likelihood of part k under the parts chosen for its ancestors.
    Chained,
    /// From the root outwards, the likelihood of the whole with the parts chosen before and the others of X_c.
    Whole,
}

impl Default for Config {
    fn default() -> Self {
        Self { coarse: 300, fine: 500, drift: 0.2, snapped: true, judging: Judging::Decoupled }
    }
}

/// A state with its log likelihood.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// The state.
    pub state: Vec<f64>,
    /// Log likelihood of the whole of it.
    pub log_likelihood: f64,
}

/// The tracker.
#[derive(Clone, Debug)]
pub struct CoarseToFine {
    config: Config,
    tree: PartTree,
    isa: Isa,
    /// The coarse particles, with X̂ as the estimate.
    state: ParticleState<Drift>,
    /// X̂ of the last frame as the only particle.
    answer: Particles,
    coarse: Judged,
    fine: Judged,
}

/// The last change of X̂, the short way round where a coordinate wraps.
#[derive(Clone, Debug)]
struct Drift {
    axes: Vec<GridAxis>,
    change: Vec<f64>,
}

impl MotionModel for Drift {
    fn dim(&self) -> usize {
        self.axes.len()
    }

    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        let Some(before) = before else { return };
        for (((change, from), to), axis) in self.change.iter_mut().zip(before).zip(estimate).zip(&self.axes) {
            *change = axis.difference(*to, *from);
        }
    }

    fn memory(&self) -> Vec<f64> {
        self.change.clone()
    }

    fn recall(&mut self, memory: &[f64]) {
        self.change.copy_from_slice(memory);
    }
}

impl CoarseToFine {
    /// A tracker that starts at `centre`, on a grid of `axes`, one a coordinate, and chooses the parts of `tree`.
    ///
    /// # Errors
    /// [`Error::Config`], [`Error::Dimension`], or no particles.
    pub fn new(config: Config, axes: Vec<GridAxis>, tree: PartTree, centre: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        let start = Judged { state: centre.clone(), log_likelihood: f64::NEG_INFINITY };
        let change = vec![0.0; axes.len()];
        let state = ParticleState::new(Drift { axes, change }, centre, config.coarse)?;
        let covered = tree.partition().parts().iter().map(|part| part.indices().len()).sum();
        check_dimension("part tree", covered, state.estimate.len())?;
        if !config.drift.is_finite() {
            return Err(Error::Config { name: "drift", value: config.drift, expected: "must be finite" });
        }
        Particles::new(&start.state, config.fine)?;
        let answer = Particles::new(&start.state, 1)?;
        Ok(Self { config, tree, isa, state, answer, coarse: start.clone(), fine: start })
    }

    /// The coarse particles with their weights, of a search.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }

    /// X_c of the last frame.
    #[must_use]
    pub fn coarse(&self) -> &Judged {
        &self.coarse
    }

    /// X̂ of the last frame.
    #[must_use]
    pub fn fine(&self) -> &Judged {
        &self.fine
    }
}

impl<O: PartLogDensity + ?Sized> Tracker<O> for CoarseToFine {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        let (Self { config, tree, isa, state, .. }, parts) = (&*self, self.tree.partition().parts().len());
        let Drift { axes, change } = &state.motion;
        check_dimension("observation", observed.dim(), axes.len())?;
        check_dimension("number of parts of the observation", observed.parts(), parts)?;
        let [to_resample, to_walk, to_refine] = stage.split(["resample", "walk", "refine"]);
        let mut particles = state.particles.clone();
        let ancestors = resample(&particles, Scheme::Multinomial, to_resample);
        let drift: Vec<f64> = change.iter().map(|change| config.drift * change).collect();
        walk(&mut particles, ancestors, &drift, axes, config.snapped, *isa, to_walk);
        let evaluations = evaluate_distinct(&mut particles, observed);
        temper(&mut particles, 1.0)?;
        let (index, log_likelihood) = best(&particles);
        let coarse = Judged { state: particles.state(index), log_likelihood };

        let mut refined = Particles::new(&coarse.state, config.fine)?;
        let widths: Vec<f64> = axes.iter().map(GridAxis::width).collect();
        diffuse(&mut refined, None, &widths, *isa, to_refine);
        let (chosen, whole) = match config.judging {
            Judging::Decoupled => (choose(&refined, observed, tree)?, false),
            Judging::Chained => (choose_chained(&refined, observed, tree)?, false),
            Judging::Whole => (choose_whole(&refined, observed, tree, &coarse.state)?, true),
        };
        let judged = config.fine * parts;
        let fine = Judged { log_likelihood: observed.log_density(&chosen), state: chosen };
        let info = StepInfo {
            mean: fine.state.clone(),
            ess: 1.0,
            survivors: vec![particles.effective_sample_size()],
            resampled: Some(true),
            likelihood_evaluations: evaluations + 1 + if whole { judged } else { 0 },
            part_evaluations: if whole { 0 } else { judged },
            ..StepInfo::default()
        };
        self.answer = Particles::new(&fine.state, 1)?;
        self.state.particles = particles;
        self.state.settle(fine.state.clone());
        (self.coarse, self.fine) = (coarse, fine);
        Ok(info)
    }
}

impl Inferred for CoarseToFine {
    /// X̂ alone: it comes without a spread.
    fn posterior(&self) -> Posterior<'_> {
        Posterior {
            dim: self.answer.dim(),
            states: self.answer.states(),
            weights: self.answer.weights(),
            effective: 1.0,
            chain_stats: &[],
        }
    }

    /// X̂ of the last frame.
    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl Resume for CoarseToFine {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)?;
        self.fine.state.clone_from(&self.state.estimate);
        Ok(())
    }
}
