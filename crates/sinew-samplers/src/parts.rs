//! Particles part by part: moves, weights, and states put together from the best parts of several.
//!
//! - [`start_part`] and [`predict_part`] apply one factor h_k of a motion h = h_1 * … * h_K that moves one part each (MacCormick & Isard 2000).
//! - [`log_likelihoods`] gives the log likelihood of each part of each state.
//! - [`choose`] picks for each part the state that explains it best, [`choose_chained`] with the parts chosen before as its ancestors, [`choose_whole`] by the likelihood of the whole. All are searches: what they put together is no draw from anything.

use crate::Error;
use crate::particles::{Particles, evaluate_by};
use crate::weights::largest;
use rayon::prelude::*;
use sinew_core::density::PartLogDensity;
use sinew_core::lanes::Block;
use sinew_core::part::{Part, PartTree};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::PartTransition;

/// Draws one part of the states of the first frame around `centre`.
pub fn start_part<T: PartTransition + ?Sized>(
    particles: &mut Particles,
    transition: &T,
    part: &Part,
    centre: &[f64],
    stage: Stage,
) {
    in_place(particles, stage, |states, rng| transition.sample_initial_part_block(part, centre, states, rng));
}

/// Moves one part of the states by the transition.
pub fn predict_part<T: PartTransition + ?Sized>(particles: &mut Particles, transition: &T, part: &Part, stage: Stage) {
    in_place(particles, stage, |states, rng| transition.sample_part_block(part, states, rng));
}

fn in_place(particles: &mut Particles, stage: Stage, change: impl Fn(&mut [Block], &mut BlockRng) + Sync) {
    let dim = particles.dim();
    let blocks = particles.states.par_chunks_mut(dim).enumerate();
    blocks.for_each(|(block, states)| change(states, &mut stage.block(block as u32)));
}

/// Log likelihoods of some parts of each state: a vector a part, in their order.
#[must_use]
pub fn log_likelihoods<D: PartLogDensity + ?Sized>(
    particles: &Particles,
    density: &D,
    parts: &[usize],
) -> Vec<Vec<f64>> {
    let scratch = || (vec![Block::ZERO; parts.len()], vec![Block::ZERO; density.workspace()]);
    let blocks: Vec<Vec<Block>> = particles
        .states()
        .par_chunks(particles.dim())
        .map_init(scratch, |(out, ws), states| {
            density.log_density_parts_block(parts, states, out, ws);
            out.clone()
        })
        .collect();
    let part_values = |k: usize| blocks.iter().flat_map(|block| block[k].0).take(particles.count()).collect();
    (0..parts.len()).map(part_values).collect()
}

/// Evaluates the log likelihood of one part of every state, for [`crate::particles::temper`].
pub fn evaluate_part<D: PartLogDensity + ?Sized>(particles: &mut Particles, density: &D, part: usize) {
    evaluate_by(particles, density.workspace(), |states, ws| {
        let mut value = [Block::ZERO];
        density.log_density_parts_block(&[part], states, &mut value, ws);
        value[0]
    });
}

/// Evaluates the log intermediate density of every state whose parts up to `part` are in place.
pub fn evaluate_intermediate<D: PartLogDensity + ?Sized>(particles: &mut Particles, density: &D, part: usize) {
    evaluate_by(particles, density.workspace(), |states, ws| density.log_intermediate_block(part, states, ws));
}

/// The state of largest value; none where no value is above −∞.
fn chosen(values: &[f64]) -> Result<usize, Error> {
    match largest(values) {
        (_, f64::NEG_INFINITY) => Err(Error::AllWeightsZero { count: values.len() }),
        (index, _) => Ok(index),
    }
}

/// The state whose part k is that of the particle with the largest log likelihood of part k; the first of equals. Each part is judged where it stands, on its own particle.
///
/// # Errors
/// [`Error::AllWeightsZero`] where no particle explains a part.
pub fn choose<D: PartLogDensity + ?Sized>(
    particles: &Particles,
    density: &D,
    tree: &PartTree,
) -> Result<Vec<f64>, Error> {
    let parts = tree.partition().parts();
    let mut state = vec![0.0; particles.dim()];
    for (part, values) in parts.iter().zip(log_likelihoods(particles, density, &(0..parts.len()).collect::<Vec<_>>())) {
        adopt(&mut state, part, &particles.state(chosen(&values)?));
    }
    Ok(state)
}

/// [`choose`] from the root outwards: part k of each particle is judged with the parts that were chosen for its ancestors in place of its own.
///
/// # Errors
/// As [`choose`].
pub fn choose_chained<D: PartLogDensity + ?Sized>(
    particles: &Particles,
    density: &D,
    tree: &PartTree,
) -> Result<Vec<f64>, Error> {
    let parts = tree.partition().parts();
    let mut state = vec![0.0; particles.dim()];
    for (k, part) in parts.iter().enumerate() {
        let mut candidates = particles.clone();
        let mut ancestor = tree.parents()[k];
        while let Some(above) = ancestor {
            for &j in parts[above].indices() {
                candidates.states.chunks_mut(state.len()).for_each(|block| block[j] = Block::splat(state[j]));
            }
            ancestor = tree.parents()[above];
        }
        let values = log_likelihoods(&candidates, density, &[k]).concat();
        adopt(&mut state, part, &particles.state(chosen(&values)?));
    }
    Ok(state)
}

/// From the root outwards, part k is that of the particle which makes the whole state likeliest: with the parts chosen before, and all others as in `base`. Count × parts evaluations of the whole likelihood.
///
/// # Errors
/// [`Error::AllWeightsZero`] where no particle's part has a likelihood.
pub fn choose_whole<D: PartLogDensity + ?Sized>(
    particles: &Particles,
    density: &D,
    tree: &PartTree,
    base: &[f64],
) -> Result<Vec<f64>, Error> {
    let mut state = base.to_vec();
    for part in tree.partition().parts() {
        let mut candidates = particles.clone();
        for (j, x) in state.iter().enumerate().filter(|(j, _)| !part.indices().contains(j)) {
            candidates.states.chunks_mut(base.len()).for_each(|block| block[j] = Block::splat(*x));
        }
        evaluate_by(&mut candidates, density.workspace(), |states, ws| density.log_density_block(states, ws));
        adopt(&mut state, part, &particles.state(chosen(&candidates.values())?));
    }
    Ok(state)
}

fn adopt(state: &mut [f64], part: &Part, from: &[f64]) {
    part.indices().iter().for_each(|&j| state[j] = from[j]);
}
