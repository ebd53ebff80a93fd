//! Hierarchical annealed particle filter (H-APF; Raskin, Rudzsky & Rivlin 2011). A **search**: what it reports is near a peak of the likelihood, and no posterior.
//!
//! A body's pose ω has latent spaces in layers: of the whole, of groups of limbs, of limbs ([`Hierarchy`]). Beside them stands λ, its place and heading. A particle of node l is [λ, θ_l, ω elsewhere]; its pose has ω|l = ℘_l(θ_l).
//! For each frame, with N particles a node, a schedule of layers h_1 … h_V and survival rate α:
//!
//! 1. (step 1) the root's particles of the frame before: λ += B_λ, θ ← φ(θ) + B_θ, by the given transition
//! 2. for each visit v, for every node l of layer h_v, from the second visit on with noise N(0, α^(v−1) Σ):
//!    - (steps 3 and 4) a layer below the last one: N particles of l's parent are drawn by their weights; λ' = λ + noise (eq. 3), θ' = φ_l(θ) + noise (eq. 4), ω' = ω but for ω'|l = ℘_l(θ') (eqs. 5, 6)
//!    - the same layer again: N particles of l itself are drawn; λ += noise, θ += noise, ω|l = ℘_l(θ)
//!    - (step 2) π_i ∝ p(z | λ_i, ω_i)^β, β by survival
//! 3. (step 5) N particles of every leaf are drawn by π, in random order; the j-th of all leaves together make λ_j, the mean of theirs, and ω_j, each coordinate from the leaf that holds it; θ_j = ℘_root⁻¹(ω_j) (eq. 8)
//! 4. (step 6) λ_opt = mean over leaves of Σ π λ; π_j ∝ p(z | λ_opt, ω_j)^β; the estimate is λ_opt and Σ π_j ω_j (eq. 9)
//!
//! Equation 9 has π of the last layer's nodes. A leaf above the last layer keeps the particles of its last visit. N (number of nodes visited + 1) evaluations a frame: with 1, 3 and 6 nodes in three layers, visited as (1, 1, 2, 3, 3), 18 N.
//! With one layer, [`Config::carry_latent`] and the weighted mean as estimate it is [`crate::gpapf`], bit for bit. No step keeps a target: noise is not corrected for, and limbs that are put together have lost what they knew of each other.

use crate::error::check_dimension;
use crate::latent_spaces::{LatentSpaces, check_schedule};
use crate::particle_state::ParticleState;
use crate::posterior::Posterior;
use crate::resume::check_length;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::combinators::Through;
use sinew_core::decode::Decode;
use sinew_core::density::LogDensity;
use sinew_core::hierarchy::Hierarchy;
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_samplers::annealed_search::{self, weigh};
use sinew_samplers::decoded::encoded;
use sinew_samplers::descent::mean_of_parts;
use sinew_samplers::particles::{Particles, aggregate};
use sinew_samplers::resample::Scheme;
use sinew_samplers::weights::effective_number;
use std::sync::Arc;

/// What a frame reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Estimate {
    /// Step 6: what step 5 put together, weighed as a whole.
    #[default]
    Reweighed,
    /// Of each leaf the weighted mean, put together.
    WeightedMean,
}

/// Settings; the default is the paper's.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N of each node.
    pub particles: usize,
    /// Layers visited, from the root's, 1, to the deepest; each is the one before or the next below.
    pub schedule: Vec<usize>,
    /// Survival rate α.
    pub survival: f64,
    /// Scheme of resampling.
    pub scheme: Scheme,
    /// What a frame reports.
    pub estimate: Estimate,
    /// Whether the particles of the last visit are kept as they are, with their weights, in place of step 5; only where the root is all there is.
    pub carry_latent: bool,
}

impl Default for Config {
    fn default() -> Self {
        let annealed_search::Config { survival, scheme, .. } = annealed_search::Config::default();
        let schedule = vec![1, 1, 2, 3, 3];
        Self { particles: 100, schedule, survival, scheme, estimate: Estimate::Reweighed, carry_latent: false }
    }
}

impl Config {
    /// The layers of annealing, and a refusal of what does not fit a hierarchy of this many layers.
    fn check(&self, layers: usize) -> Result<annealed_search::Config, Error> {
        check_schedule(&self.schedule, layers)?;
        if self.carry_latent && layers > 1 {
            let expected = "must be 1 for latents that are carried over";
            return Err(Error::Config { name: "number of layers", value: layers as f64, expected });
        }
        let Self { survival, scheme, .. } = *self;
        Ok(annealed_search::Config { layers: self.schedule.len(), survival, scheme, ..Default::default() })
    }
}

/// The tracker.
#[derive(Clone, Debug)]
pub struct HApf<T> {
    config: Config,
    spaces: LatentSpaces,
    /// Of the root, as the next frame begins.
    state: ParticleState<T>,
    poses: Vec<Block>,
    estimate: Vec<f64>,
}

impl<T: Transition> HApf<T> {
    /// A tracker that starts at a pose [λ, ω]. `motion` moves [λ, θ] of the root from frame to frame; `lambda_sd` are the standard deviations of λ's noise; the nodes have their latents'.
    ///
    /// # Errors
    /// [`Error::Config`], [`Error::Dimension`], [`Error::NotEncoded`], standard deviations out of range, or no particles.
    pub fn new(
        config: Config,
        hierarchy: Arc<Hierarchy>,
        motion: T,
        lambda_sd: &[f64],
        pose: &[f64],
        isa: Isa,
    ) -> Result<Self, Error> {
        check_dimension("start", pose.len(), lambda_sd.len() + hierarchy.dim())?;
        let layers = config.check(hierarchy.layers())?;
        let spaces = LatentSpaces::new(hierarchy, lambda_sd, layers, isa)?;
        let root = spaces.decoder(0).encode(pose).ok_or(Error::NotEncoded)?;
        let mut estimate = vec![0.0; pose.len()];
        spaces.decoder(0).decode(&root, &mut estimate);
        let state = ParticleState::new(motion, root, config.particles)?;
        Ok(Self { config, spaces, state, poses: vec![], estimate })
    }
}

impl<T: Transition + Send, O: LogDensity + ?Sized> Tracker<O> for HApf<T> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.estimate.len())?;
        let (Config { particles: count, schedule, survival, .. }, spaces) = (&self.config, &self.spaces);
        let [to_resample, to_predict, to_anneal] = stage.split(["resample", "predict", "layers"]);
        let [to_renew, to_diffuse, to_draw, to_pair] = to_anneal.split(["resample", "diffuse", "draw", "pair"]);
        // Step 1; before the first visit of a node, the root's particles stand in its place.
        let root = self.state.moved(self.config.carry_latent.then_some(self.config.scheme), to_resample, to_predict);
        let mut sets = vec![root; spaces.hierarchy.nodes().len()];
        let (mut renewals, mut layers) = (0, vec![]);
        for (visit, &layer) in schedule.iter().enumerate() {
            for node in spaces.hierarchy.layer(layer) {
                // Steps 3 and 4.
                if visit > 0 {
                    renewals += 1;
                    let stages = [&to_renew, &to_diffuse].map(|stage| stage.round(renewals));
                    sets[node] = spaces.renewed(&sets, node, layer > schedule[visit - 1], visit, stages);
                }
                // Step 2.
                let density = Through { target: observed, decoder: spaces.decoder(node) };
                layers.push(weigh(&mut sets[node], &density, *survival, None)?);
            }
        }
        // Step 5, but for θ.
        let mut parts = spaces.parts(&sets);
        let poses = spaces.assembled(&sets, &parts, [to_draw, to_pair]);
        // Step 6.
        let mut mean = mean_of_parts(&parts, spaces.free, self.estimate.len());
        if self.config.estimate == Estimate::Reweighed {
            let mut whole = Particles::of(mean.len(), *count, spaces.placed(&poses, &mean));
            layers.push(weigh(&mut whole, observed, *survival, None)?);
            mean.splice(spaces.free.., aggregate(&whole).drain(spaces.free..));
        }
        let ess = parts.iter().map(|part| effective_number(part.weights)).fold(f64::INFINITY, f64::min);
        (self.state.particles, self.poses) = if self.config.carry_latent {
            (sets[0].clone(), parts.remove(0).poses)
        } else {
            let root = encoded(&poses, *count, spaces.decoder(0)).ok_or(Error::NotEncoded)?;
            (Particles::of(spaces.decoder(0).source_dim(), *count, root), poses)
        };
        self.estimate.clone_from(&mean);
        Ok(StepInfo {
            mean,
            ess,
            resampled: Some(self.state.settle(aggregate(&self.state.particles))),
            exponents: layers.iter().map(|layer| layer.exponent).collect(),
            survivors: layers.iter().map(|layer| layer.survivors).collect(),
            likelihood_evaluations: count * layers.len(),
            ..StepInfo::default()
        })
    }
}

impl<T: MotionModel> Inferred for HApf<T> {
    /// What the next frame begins with, as poses: of a search, and no posterior.
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior().as_poses(&self.poses, self.estimate.len())
    }

    fn estimate(&self) -> &[f64] {
        &self.estimate
    }
}

impl<T: MotionModel> Resume for HApf<T> {
    fn save(&self) -> Vec<f64> {
        [&self.estimate[..], &self.state.save()].concat()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        let Some((estimate, root)) = saved.split_at_checked(self.estimate.len()) else {
            return check_length(saved.len(), self.estimate.len());
        };
        self.state.restore(root)?;
        self.estimate.copy_from_slice(estimate);
        self.poses.clear();
        Ok(())
    }
}
