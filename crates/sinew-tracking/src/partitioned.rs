//! Partitioned sampling: the state is moved and weighed part by part.
//! Particles are not spent on all combinations of all parts (MacCormick & Blake 1999; MacCormick & Isard 2000).
//!
//! For each frame t, with N particles, parts 1 … K, a motion h = h_1 * … * h_K that moves one part each, and importance functions g_k > 0:
//!
//! 1. π = 1/N on the particles that resampling by W_{t−1} leaves; in the first frame on the given start
//! 2. for each part k = 1 … K:
//!    - s_i ← h_k(s_i)
//!    - k < K: weighted resampling by g_k ([`sinew_samplers::weighted_resampling`]): s ← s_(a), π ← π_(a) / (N ρ_(a)), a ~ ρ ∝ g_k; D_k = 1 / Σ ρ²
//! 3. W ∝ π f with the whole likelihood f; D_K = 1 / Σ W²
//! 4. estimate = Σ W_i s_i, log evidence of the frame = log Σ π f
//!
//! Where f = Π g_k, and g_k depends on no later part, step 2 multiplies π by g_k before it divides by it, and step 3 is left with the last factor: the same weights for fewer evaluations.
//!
//! A likelihood that is no such product, as that of silhouettes, may have intermediate densities F_k instead: the likelihood of the whole state with the parts after k where the last frame left them, or a power of it. Step 2
//! then chooses by ρ ∝ π F_k, which leaves π ∝ 1 / F_k: the importance functions are g_k = F_k / F_(k−1), their product telescopes, and step 3 weighs by f / F_(K−1). K N evaluations of the whole a frame.
//!
//! **Exact for every positive g**, evidence included: only the variance depends on it. A g_k of zero where f is not loses what stands there. The least D_k is reported as the effective number: a part that few states
//! survived does not become many again when later parts move. D_k far below N says that part k is too much for N particles at once:
//! N = D / α serves for a D in each part of survival rate α, where all at once would need D / α^K. (K − 1) N evaluations of parts and N of the whole a frame; K N of parts where f is their product.

use crate::error::check_dimension;
use crate::particle_state::ParticleState;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::density::PartLogDensity;
use sinew_core::part::{Part, PartTree};
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, PartTransition};
use sinew_samplers::particles::{Particles, aggregate, resample, reweight, take, temper};
use sinew_samplers::parts::{evaluate_intermediate, evaluate_part, predict_part, start_part};
use sinew_samplers::resample::Scheme;
use sinew_samplers::weighted_resampling::weighted_resample;

/// Settings; the default resamples multinomially.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N.
    pub particles: usize,
    /// Resampling scheme, between frames and between parts.
    pub scheme: Scheme,
}

impl Default for Config {
    fn default() -> Self {
        Self { particles: 1000, scheme: Scheme::Multinomial }
    }
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Partitioned<T> {
    config: Config,
    tree: PartTree,
    state: ParticleState<T>,
    survivors: Vec<f64>,
}

impl<T: PartTransition> Partitioned<T> {
    /// A filter that starts around `centre` and takes the parts of `tree` in their order.
    ///
    /// # Errors
    /// [`Error::Dimension`], or no particles.
    pub fn new(config: Config, transition: T, tree: PartTree, centre: Vec<f64>) -> Result<Self, Error> {
        let state = ParticleState::new(transition, centre, config.particles)?;
        let covered = tree.partition().parts().iter().map(|part| part.indices().len()).sum();
        check_dimension("part tree", covered, state.estimate.len())?;
        Ok(Self { config, tree, state, survivors: vec![] })
    }

    /// The particles with their weights.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }

    /// Survival diagnostic D of each part in the last frame.
    #[must_use]
    pub fn survivors(&self) -> &[f64] {
        &self.survivors
    }

    fn parts(&self) -> &[Part] {
        self.tree.partition().parts()
    }
}

/// Log importance of each state for the choice of part k, and the evidence that its weights have gained on the way.
fn importance<O: PartLogDensity + ?Sized>(
    particles: &mut Particles,
    observed: &O,
    k: usize,
) -> Result<(Vec<f64>, f64), Error> {
    if !observed.is_product() && observed.has_intermediates() {
        evaluate_intermediate(particles, observed, k);
        let weighted = particles.log_weights().iter().zip(particles.values()).map(|(weight, value)| weight + value);
        return Ok((weighted.collect(), 0.0));
    }
    evaluate_part(particles, observed, k);
    let values = particles.values();
    let gained = if observed.is_product() { temper(particles, 1.0)? } else { 0.0 };
    Ok((values, gained))
}

impl<T: PartTransition + Send, O: PartLogDensity + ?Sized> Tracker<O> for Partitioned<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.state.estimate.len())?;
        check_dimension("number of parts of the observation", observed.parts(), self.parts().len())?;
        let Config { particles: count, scheme } = self.config;
        let [to_resample, to_predict, to_select] = stage.split(["resample", "predict", "select"]);
        let ParticleState { motion, estimate, started, .. } = &self.state;
        let mut particles = self.state.particles.clone();
        if *started {
            let ancestors = resample(&particles, scheme, to_resample);
            take(&mut particles, ancestors);
        }
        let (is_product, last) = (observed.is_product(), self.parts().len() - 1);
        let (mut log_evidence, mut survivors) = (0.0, vec![]);
        for (k, part) in self.parts().iter().enumerate() {
            let to_move = to_predict.round(k);
            if *started {
                predict_part(&mut particles, motion, part, to_move);
            } else {
                start_part(&mut particles, motion, part, estimate, to_move);
            }
            if k == last && !is_product {
                log_evidence += reweight(&mut particles, observed)?;
                break;
            }
            let (importance, gained) = importance(&mut particles, observed, k)?;
            log_evidence += gained;
            if k < last {
                let reselected = weighted_resample(&mut particles, &importance, scheme, to_select.round(k))?;
                log_evidence += reselected.log_sum;
                survivors.push(reselected.survivors);
            }
        }
        let mean = aggregate(&particles);
        survivors.push(particles.effective_sample_size());
        let ess = survivors.iter().copied().fold(f64::INFINITY, f64::min);
        let (parts, whole) = match (is_product, observed.has_intermediates()) {
            (true, _) => (last + 1, 0),
            (_, true) => (0, last + 1),
            _ => (last, 1),
        };
        (self.state.particles, self.survivors) = (particles, survivors);
        Ok(StepInfo {
            ess,
            log_evidence: Some(log_evidence),
            resampled: Some(self.state.settle(mean.clone())),
            mean,
            survivors: self.survivors.clone(),
            likelihood_evaluations: count * whole,
            part_evaluations: count * parts,
            ..StepInfo::default()
        })
    }
}

impl<T: MotionModel> Inferred for Partitioned<T> {
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior()
    }

    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl<T: MotionModel> Resume for Partitioned<T> {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)
    }
}
