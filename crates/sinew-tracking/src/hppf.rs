//! Hierarchical partitioned particle filter (Husz, Wallace & Green 2007, figure 1). A **search**: it reports the mean of what it has found near its best state, and no posterior.
//!
//! For each frame t, with N particles p_i and the parts of a body by their depth in its tree, the levels l = 1 … L:
//!
//! 1. whole particles are resampled by the weights of the last frame
//! 2. for each level l:
//!    - (a) motion: p_x moves for every part x of depth l, and slightly what is above the level ([`LevelMotion`])
//!    - (b) weights: w_i(x) = ψ(p_x) λ(I | p_x) (eq. 1), for every part of the level and for all parts above it together, each judged on the whole particle as it stands
//!    - (c) resampling of each part on its own: slot i receives the coordinates x of its ancestor alone, with their origin ([`PartOrigins`]); first the parts of the level, then what is above it
//! 3. w_i = ψ(p_i) λ_G(p_i), by the whole state ([`PartLogDensity::global_block`], eq. 10)
//! 4. mode = particle of largest w among those that meet the most of what was seen; estimate = weighted mean of the particles similar to it ([`sinew_samplers::mode_mean`])
//!
//! All resampling: only the highest 80 % survive ([`Truncation`](sinew_samplers::resample::Truncation)); they keep their slots, so that only refilled parts mix between particles. At the first level a part carries all that hangs on it, so that with one root whole
//! particles are resampled. The paper resamples by w_i at the end of a frame; here its particles keep w_i as their weights until the next.
//!
//! **What keeps a target.** The motion (a) by a random walk alone draws from a random walk whose variance is B² and what the tuning adds; by action primitives later levels overwrite earlier ones, which is no transition with a density. The weights (b) use λ of a part
//! at its level and again above the next one, and never divide it out, so that torso and upper limbs count several times. Truncation (c) is biased, and states put together from several have lost what their parts knew of each other: no product of parts would be
//! kept even if the likelihood were one. λ_G replaces the product of λ and does not multiply it. Only step 3, were the particles a sample of something, would weigh it as importance sampling does. So weights and spread mean nothing but a ranking.
//!
//! (number of parts judged, level by level) N evaluations of parts and N of the whole a frame: for ten parts in three levels (1 + 6 + 10) N.

use crate::error::check_dimension;
use crate::particle_state::ParticleState;
use crate::posterior::Posterior;
use crate::{Error, Inferred, Resume, StepInfo, Tracker};
use sinew_core::density::PartLogDensity;
use sinew_core::part::PartTree;
use sinew_core::random::Stage;
use sinew_core::transition::LevelMotion;
use sinew_samplers::levels::{Selection, log_global, log_plausibilities, predict_level, resample_part};
use sinew_samplers::mode_mean::{ModeMean, mode_mean};
use sinew_samplers::origins::PartOrigins;
use sinew_samplers::particles::{Particles, select, take};
use sinew_samplers::parts::log_likelihoods;

/// Settings; the default is what the paper mostly uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Number of particles N.
    pub particles: usize,
    /// What survives resampling.
    pub selection: Selection,
    /// How far particles similar to the mode are from it at most, in standard deviations B of a step.
    pub width: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self { particles: 200, selection: Selection::default(), width: 3.0 }
    }
}

/// Parts that are resampled together.
#[derive(Clone, Debug)]
struct Partition {
    /// The parts, as places in [`Level::judged`].
    places: core::ops::Range<usize>,
    /// Their own coordinates.
    own: Vec<usize>,
    /// What an ancestor hands on.
    carried: Vec<usize>,
}

/// A level of the tree.
#[derive(Clone, Debug)]
struct Level {
    /// The parts of its depth, then those above.
    judged: Vec<usize>,
    partitions: Vec<Partition>,
}

impl Level {
    fn new(tree: &PartTree, parts: &[usize], above: &[usize]) -> Self {
        let alone = |(place, &part): (usize, &usize)| {
            let own = tree.coordinates(&[part]);
            let below = if above.is_empty() { tree.coordinates(&tree.descendants(part)) } else { vec![] };
            Partition { places: place..place + 1, carried: [&own[..], &below].concat(), own }
        };
        let mut partitions: Vec<Partition> = parts.iter().enumerate().map(alone).collect();
        if !above.is_empty() {
            let (own, places) = (tree.coordinates(above), parts.len()..parts.len() + above.len());
            partitions.push(Partition { places, carried: own.clone(), own });
        }
        Self { judged: [parts, above].concat(), partitions }
    }
}

/// The tracker.
#[derive(Clone, Debug)]
pub struct Hppf<M> {
    config: Config,
    parts: usize,
    levels: Vec<Level>,
    state: ParticleState<M>,
    found: Option<ModeMean>,
}

impl<M: LevelMotion> Hppf<M> {
    /// A tracker that starts at `centre` and walks down the parts of `tree`, which `motion` has, too.
    ///
    /// # Errors
    /// [`Error::Config`], [`Error::Dimension`], or no particles.
    pub fn new(config: Config, motion: M, tree: &PartTree, centre: Vec<f64>) -> Result<Self, Error> {
        let (value, expected) = (config.selection.surviving, "must be above 0 and at most 1");
        if !(value > 0.0 && value <= 1.0) {
            return Err(Error::Config { name: "share that survives", value, expected });
        }
        let (depths, parts) = (tree.levels(), tree.parents().len());
        let levels: Vec<Level> =
            depths.iter().enumerate().map(|(l, parts)| Level::new(tree, parts, &depths[..l].concat())).collect();
        check_dimension("part tree", tree.coordinates(&(0..parts).collect::<Vec<_>>()).len(), centre.len())?;
        Ok(Self { parts, levels, state: ParticleState::new(motion, centre, config.particles)?, found: None, config })
    }

    /// The particles with their weights, of a search.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.state.particles
    }

    /// The mode of the last frame, the particles similar to it, and how many met less of what was seen.
    #[must_use]
    pub fn found(&self) -> Option<&ModeMean> {
        self.found.as_ref()
    }
}

impl<M: LevelMotion + Send, O: PartLogDensity + ?Sized> Tracker<O> for Hppf<M> {
    fn step(&mut self, observed: &O, stage: Stage) -> Result<StepInfo, Error> {
        check_dimension("observation", observed.dim(), self.state.estimate.len())?;
        check_dimension("number of parts of the observation", observed.parts(), self.parts)?;
        let (ParticleState { motion, started, .. }, selection) = (&self.state, self.config.selection);
        let [to_resample, to_move, to_select] = stage.split(["resample", "move", "select"]);
        let (mut particles, mut survivors) = (self.state.particles.clone(), vec![]);
        if *started {
            let ancestors = selection.ancestors(particles.weights(), to_resample);
            take(&mut particles, ancestors);
        }
        let mut origins = PartOrigins::new(particles.clone(), self.parts);
        for (l, Level { judged, partitions }) in self.levels.iter().enumerate() {
            predict_level(&mut particles, &mut origins, motion, l, to_move.round(l));
            let likelihoods = log_likelihoods(&particles, observed, judged);
            let weight = |partition: &Partition| {
                let mut log = log_plausibilities(&particles, motion, &partition.own);
                for likelihoods in &likelihoods[partition.places.clone()] {
                    log.iter_mut().zip(likelihoods).for_each(|(log, likelihood)| *log += likelihood);
                }
                log
            };
            let weights: Vec<Vec<f64>> = partitions.iter().map(weight).collect();
            for (Partition { places, carried, .. }, weights) in partitions.iter().zip(&weights) {
                let (parts, stage) = (&judged[places.clone()], to_select.round(survivors.len()));
                survivors.push(resample_part(&mut particles, &mut origins, parts, carried, weights, selection, stage)?);
            }
        }
        let [log_likelihoods, met] = log_global(&particles, observed);
        let all: Vec<usize> = (0..particles.dim()).collect();
        let plausible = log_plausibilities(&particles, motion, &all);
        let weights: Vec<f64> = plausible.iter().zip(&log_likelihoods).map(|(psi, lambda)| psi + lambda).collect();
        select(&mut particles, (0..weights.len()).collect(), &weights)?;
        let found = mode_mean(&particles, &met, motion, self.config.width)?;
        survivors.push(particles.effective_sample_size());
        let count = particles.count();
        self.state.particles = particles;
        let info = StepInfo {
            ess: self.state.particles.effective_sample_size(),
            resampled: Some(self.state.settle(found.mean.clone())),
            mean: found.mean.clone(),
            survivors,
            choices: origins.shares(),
            likelihood_evaluations: count,
            part_evaluations: count * self.levels.iter().map(|level| level.judged.len()).sum::<usize>(),
            ..StepInfo::default()
        };
        self.found = Some(found);
        Ok(info)
    }
}

impl<M: LevelMotion> Inferred for Hppf<M> {
    /// What survived, with its weights: a ranking.
    fn posterior(&self) -> Posterior<'_> {
        self.state.posterior()
    }

    fn estimate(&self) -> &[f64] {
        &self.state.estimate
    }
}

impl<M: LevelMotion> Resume for Hppf<M> {
    fn save(&self) -> Vec<f64> {
        self.state.save()
    }

    fn restore(&mut self, saved: &[f64]) -> Result<(), Error> {
        self.state.restore(saved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::part::{Part, Partition as Parts};

    /// A root, two limbs on it and one more on the first of these; coordinate j belongs to part j. Each level judges its parts and those above; a part that is resampled takes along what hangs on it at the first level only, as what hangs on a later one has its own turn.
    #[test]
    fn levels_are_judged_and_resampled_part_by_part() {
        let parts = (0..4).map(|j| Part::new(vec![j], 4).expect("valid")).collect();
        let partition = Parts::new(parts, 4).expect("covers");
        let tree = PartTree::new(partition, vec![None, Some(0), Some(0), Some(1)]).expect("parents first");
        let depths = tree.levels();
        let levels: Vec<Level> = (0..3).map(|l| Level::new(&tree, &depths[l], &depths[..l].concat())).collect();
        // Of each partition the parts by which it is judged, its own coordinates, and those that it takes along.
        let expected: [&[[&[usize]; 3]]; 3] = [
            &[[&[0], &[0], &[0, 1, 2, 3]]],
            &[[&[1], &[1], &[1]], [&[2], &[2], &[2]], [&[0], &[0], &[0]]],
            &[[&[3], &[3], &[3]], [&[0, 1, 2], &[0, 1, 2], &[0, 1, 2]]],
        ];
        for (Level { judged, partitions }, expected) in levels.iter().zip(expected) {
            assert_eq!(partitions.len(), expected.len());
            for (found, [parts, coordinates, all]) in partitions.iter().zip(expected) {
                assert_eq!((&judged[found.places.clone()], &found.own[..]), (*parts, *coordinates));
                let mut carried = found.carried.clone();
                carried.sort_unstable();
                assert_eq!(carried, *all);
            }
        }
    }
}
