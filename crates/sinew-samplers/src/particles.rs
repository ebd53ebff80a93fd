//! Weighted states in blocks of eight, and the verbs of a particle filter on them.
//!
//! [`Particles`] holds `count` states, dimension-major in blocks: state i is lane i mod 8 of block i / 8. The lanes of the last block beyond `count` are moved along and never counted. The population before
//! the last [`predict`] is kept as well, with the place in it of each state's ancestor.
//!
//! A step of a bootstrap filter is [`resample()`], [`predict`], [`reweight`], [`aggregate`]. Resampling only draws ancestors; [`predict`] gathers and moves them in one pass, since a large population is bound by
//! memory and not by arithmetic, and [`predict_and_reweight`] evaluates each block while it is in the cache. Blocks are mapped in parallel, each with its own random stream; sums are taken in index order, so the thread count does not change a bit.
//!
//! Where the exponent of the likelihood depends on its values, [`reweight`] is [`evaluate`] and [`temper`]; where the states move by a rule that is no transition, [`predict`] is [`move_by`]; where they are chosen by
//! other probabilities than their weights, [`select`] takes them with the weights that they keep.

use crate::population::Population;
use crate::resample::{self, Ancestors, Scheme};
use crate::weights::{effective_number, largest, normalise};
use crate::{Error, moments};
use rayon::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, LANES, numbers};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::Transition;

/// Blocks that one task moves at least: some microseconds of work with the cheapest likelihoods, and with images, where a block takes a fifth of a millisecond, still several tasks for a population of two hundred.
const BLOCKS_A_TASK: usize = 4;

/// A weighted set of states.
#[derive(Clone, Debug)]
pub struct Particles {
    dim: usize,
    count: usize,
    pub(crate) states: Vec<Block>,
    log_weights: Vec<f64>,
    weights: Vec<f64>,
    pub(crate) previous: Vec<Block>,
    previous_log_weights: Vec<f64>,
    ancestors: Option<Ancestors>,
    pub(crate) values: Vec<Block>,
    room: Room,
}

/// Memory that a step uses again, so that it allocates nothing once it is there. What it holds between two calls means nothing, so a copy of the particles goes without.
#[derive(Debug, Default)]
struct Room {
    ancestors: Ancestors,
    resample: resample::Room,
    log_weights: Vec<f64>,
    weights: Vec<f64>,
}

impl Clone for Room {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Particles {
    /// `count` states at one point, equally weighted.
    ///
    /// # Errors
    /// [`Error::Empty`].
    pub fn new(centre: &[f64], count: usize) -> Result<Self, Error> {
        let dim = centre.len();
        if count == 0 || dim == 0 {
            return Err(Error::Empty { count, dim });
        }
        let blocks = count.div_ceil(LANES);
        let states = (0..blocks).flat_map(|_| centre.iter().map(|&x| Block::splat(x))).collect();
        Ok(Self::of(dim, count, states))
    }

    /// `count` states in blocks of eight, equally weighted.
    #[must_use]
    pub fn of(dim: usize, count: usize, states: Vec<Block>) -> Self {
        Self {
            dim,
            count,
            previous: states.clone(),
            values: vec![Block::ZERO; states.len() / dim],
            states,
            log_weights: vec![-(count as f64).ln(); count],
            previous_log_weights: vec![-(count as f64).ln(); count],
            weights: vec![1.0 / count as f64; count],
            ancestors: None,
            room: Room::default(),
        }
    }

    /// States one after the other, equally weighted.
    ///
    /// # Errors
    /// [`Error::Empty`], [`Error::Uneven`].
    pub fn from_slice(dim: usize, states: &[f64]) -> Result<Self, Error> {
        Ok(Self::equally_weighted(&Population::from_slice(dim, states)?))
    }

    /// The states of a population, equally weighted.
    pub(crate) fn equally_weighted(population: &Population) -> Self {
        Self::of(population.dim(), population.count(), population.states().to_vec())
    }

    /// The states without their weights.
    pub(crate) fn population(&self) -> Population {
        Population::from_state_blocks(self.dim(), self.count(), self.states().to_vec())
    }

    /// Dimension of the state.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of states.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count
    }

    /// The states, blocks of `dim` [`Block`]s.
    #[must_use]
    pub fn states(&self) -> &[Block] {
        &self.states
    }

    /// One state.
    #[must_use]
    pub fn state(&self, index: usize) -> Vec<f64> {
        self.states[index / LANES * self.dim..][..self.dim].iter().map(|b| b.0[index % LANES]).collect()
    }

    /// What the last evaluation said of each state.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.values.iter().flat_map(|b| b.0).take(self.count).collect()
    }

    /// The population before the last [`predict`], stored alike.
    #[must_use]
    pub fn previous(&self) -> &[Block] {
        &self.previous
    }

    /// Places in [`Particles::previous`] of the states that these came from; nothing where each came from itself.
    #[must_use]
    pub fn ancestors(&self) -> &[usize] {
        self.ancestors.as_deref().unwrap_or_default()
    }

    /// Place in [`Particles::previous`] of the state that state `index` came from.
    #[must_use]
    pub fn ancestor(&self, index: usize) -> usize {
        self.ancestors.as_ref().map_or(index, |a| a[index])
    }

    /// Logarithms of the normalised weights.
    #[must_use]
    pub fn log_weights(&self) -> &[f64] {
        &self.log_weights
    }

    /// The normalised weights.
    #[must_use]
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Stands where particles of the same number and dimension stood that had these states, logarithms of weights and weights. There is no population before.
    ///
    /// # Panics
    /// Where they are of another size.
    pub fn restore(&mut self, states: Vec<Block>, log_weights: &[f64], weights: &[f64]) {
        assert_eq!(states.len(), self.states.len());
        self.states = states;
        self.log_weights.copy_from_slice(log_weights);
        self.weights.copy_from_slice(weights);
        self.ancestors = None;
    }

    /// Effective number of states.
    #[must_use]
    pub fn effective_sample_size(&self) -> f64 {
        effective_number(&self.weights)
    }
}

/// Draws all states of the first frame around `centre`.
pub fn start<T: Transition + ?Sized>(particles: &mut Particles, transition: &T, centre: &[f64], stage: Stage) {
    let dim = particles.dim;
    particles.states.par_chunks_mut(dim).with_min_len(BLOCKS_A_TASK).enumerate().for_each_init(
        || stage.blocks(),
        |rngs, (block, states)| transition.sample_initial_block(centre, states, rngs.block(block as u32)),
    );
}

/// Draws the ancestors of a new population by the weights.
#[must_use]
pub fn resample(particles: &Particles, scheme: Scheme, stage: Stage) -> Ancestors {
    scheme.ancestors(&particles.weights, particles.count, &mut stage.whole())
}

/// [`resample()`] in memory of the particles, which get it back by the next [`predict`].
#[must_use]
pub fn resample_in_room(particles: &mut Particles, scheme: Scheme, stage: Stage) -> Ancestors {
    let Particles { weights, count, room, .. } = particles;
    let mut ancestors = std::mem::take(&mut room.ancestors);
    scheme.fill(weights, *count, &mut stage.whole(), &mut ancestors, &mut room.resample);
    ancestors
}

/// Moves the states by the transition: each from its ancestor, with equal weights, or without `ancestors` each from itself, with the weight it has.
pub fn predict<T: Transition + ?Sized>(
    particles: &mut Particles,
    ancestors: Option<Ancestors>,
    transition: &T,
    stage: Stage,
) {
    move_by(particles, ancestors, |from, to, rng| transition.sample_block(from, to, rng), stage);
}

/// [`predict`] by any rule: `moved` writes the next states of a block from the ones that they come from.
pub fn move_by(
    particles: &mut Particles,
    ancestors: Option<Ancestors>,
    moved: impl Fn(&[Block], &mut [Block], &mut BlockRng) + Sync,
    stage: Stage,
) {
    let rngs = || stage.blocks();
    advance(particles, ancestors, rngs, |rngs, block, from, to| {
        moved(from, to, rngs.block(block as u32));
        Block::ZERO
    });
}

/// Takes the states of these ancestors, with equal weights.
pub fn take(particles: &mut Particles, ancestors: Ancestors) {
    advance(
        particles,
        Some(ancestors),
        || (),
        |(), _, from, to| {
            to.copy_from_slice(from);
            Block::ZERO
        },
    );
}

/// Takes the states of these ancestors, with the weights of these logarithms, which need not be normalised. Returns the logarithm of their sum.
///
/// # Errors
/// [`Error::AllWeightsZero`], [`Error::BadWeight`]; nothing has changed then.
pub fn select(particles: &mut Particles, ancestors: Ancestors, log_weights: &[f64]) -> Result<f64, Error> {
    let mut weights = Vec::new();
    let log_sum = normalise(log_weights, &mut weights)?;
    take(particles, ancestors);
    particles.weights = weights;
    particles.log_weights.iter_mut().zip(log_weights).for_each(|(w, l)| *w = l - log_sum);
    Ok(log_sum)
}

/// [`predict`] and [`reweight`] in one pass over the states.
///
/// # Errors
/// As [`reweight`]; the states have moved, and [`retreat`] takes that back.
pub fn predict_and_reweight<T: Transition + ?Sized, D: LogDensity + ?Sized>(
    particles: &mut Particles,
    ancestors: Option<Ancestors>,
    transition: &T,
    likelihood: &D,
    stage: Stage,
) -> Result<f64, Error> {
    let scratch = || (stage.blocks(), vec![Block::ZERO; likelihood.workspace()]);
    advance(particles, ancestors, scratch, |(rngs, ws), block, from, to| {
        transition.sample_block(from, to, rngs.block(block as u32));
        likelihood.log_density_block(to, ws)
    });
    temper(particles, 1.0)
}

/// Moves the states by a proposal and multiplies their weights: `proposed` writes the next states of a block, whose number it gets, from the ones that they come from, and returns the logarithms of their factors, with `workspace` blocks of scratch. Returns log Σ W_i exp l_i.
///
/// # Errors
/// As [`reweight`]; the states have moved, and [`retreat`] takes that back.
pub fn propose_and_reweight(
    particles: &mut Particles,
    ancestors: Option<Ancestors>,
    workspace: usize,
    proposed: impl Fn(usize, &[Block], &mut [Block], &mut [Block]) -> Block + Sync,
) -> Result<f64, Error> {
    let scratch = || vec![Block::ZERO; workspace];
    advance(particles, ancestors, scratch, |ws, block, from, to| proposed(block, from, to, ws));
    temper(particles, 1.0)
}

/// Moves the states and keeps what `moved` says of each moved block, with scratch that a task makes once.
fn advance<S>(
    particles: &mut Particles,
    ancestors: Option<Ancestors>,
    scratch: impl Fn() -> S + Sync + Send,
    moved: impl Fn(&mut S, usize, &[Block], &mut [Block]) -> Block + Sync,
) {
    let Particles { dim, count, states, previous, values, .. } = particles;
    let d = *dim;
    std::mem::swap(states, previous);
    let blocks = states.par_chunks_mut(d).zip(values);
    blocks.with_min_len(BLOCKS_A_TASK).enumerate().for_each_init(
        || (vec![Block::ZERO; d], scratch()),
        |(gathered, scratch), (block, (next, out))| {
            *out = match &ancestors {
                None => moved(scratch, block, &previous[block * d..][..d], next),
                Some(ancestors) => {
                    gather(previous, &ancestors[block * LANES..], gathered);
                    moved(scratch, block, gathered, next)
                }
            };
        },
    );
    particles.previous_log_weights.copy_from_slice(&particles.log_weights);
    if ancestors.is_some() {
        particles.log_weights.fill(-(*count as f64).ln());
        particles.weights.fill(1.0 / *count as f64);
    }
    let former = std::mem::replace(&mut particles.ancestors, ancestors);
    particles.room.ancestors = former.unwrap_or_default();
}

/// The states of the first eight ancestors, or fewer.
fn gather(previous: &[Block], ancestors: &[usize], gathered: &mut [Block]) {
    let ancestors = &ancestors[..ancestors.len().min(LANES)];
    if let [gathered] = gathered {
        let previous = numbers(previous);
        gathered.0.iter_mut().zip(ancestors).for_each(|(new, &ancestor)| *new = previous[ancestor]);
        return;
    }
    let d = gathered.len();
    for (lane, &ancestor) in ancestors.iter().enumerate() {
        let old = &previous[ancestor / LANES * d..][..d];
        for (new, old) in gathered.iter_mut().zip(old) {
            new.0[lane] = old.0[ancestor % LANES];
        }
    }
}

/// Takes the last [`predict`] back.
pub fn retreat(particles: &mut Particles) {
    std::mem::swap(&mut particles.states, &mut particles.previous);
    particles.log_weights.copy_from_slice(&particles.previous_log_weights);
    particles.weights.iter_mut().zip(&particles.log_weights).for_each(|(w, l)| *w = l.exp());
    particles.ancestors = None;
}

/// Multiplies the weights by the likelihood and normalises them. Returns log Σ W_i exp l_i, the evidence of the observation given the earlier ones.
///
/// # Errors
/// [`Error::AllWeightsZero`], [`Error::BadWeight`]; the weights are then those before the call.
pub fn reweight<D: LogDensity + ?Sized>(particles: &mut Particles, likelihood: &D) -> Result<f64, Error> {
    evaluate(particles, likelihood);
    temper(particles, 1.0)
}

/// Evaluates the log likelihood of every state, for [`temper`].
pub fn evaluate<D: LogDensity + ?Sized>(particles: &mut Particles, likelihood: &D) {
    let value = |states: &[Block], ws: &mut [Block]| likelihood.log_density_block(states, ws);
    evaluate_by(particles, likelihood.workspace(), value);
}

/// Keeps what `value` says of each block, with `workspace` blocks of scratch.
pub(crate) fn evaluate_by(
    particles: &mut Particles,
    workspace: usize,
    value: impl Fn(&[Block], &mut [Block]) -> Block + Sync,
) {
    let Particles { dim, states, values, .. } = particles;
    values
        .par_iter_mut()
        .zip(states.par_chunks(*dim))
        .with_min_len(BLOCKS_A_TASK)
        .for_each_init(|| vec![Block::ZERO; workspace], |ws, (out, states)| *out = value(states, ws));
}

/// Multiplies the weights by the likelihood of the last evaluation raised to `beta` and normalises them; a likelihood of zero stays zero for every exponent, 0 included. Returns log Σ W_i exp β l_i.
///
/// # Errors
/// [`Error::AllWeightsZero`], [`Error::BadWeight`]; the weights are then those before the call.
pub fn temper(particles: &mut Particles, beta: f64) -> Result<f64, Error> {
    let Particles { values, log_weights, weights, room, .. } = particles;
    let power = |l: f64| if l == f64::NEG_INFINITY { l } else { beta * l };
    room.log_weights.clear();
    room.log_weights.extend(log_weights.iter().zip(numbers(values)).map(|(w, l)| w + power(*l)));
    let evidence = normalise(&room.log_weights, &mut room.weights)?;
    std::mem::swap(weights, &mut room.weights);
    log_weights.iter_mut().zip(&room.log_weights).for_each(|(w, u)| *w = u - evidence);
    Ok(evidence)
}

/// Place and log likelihood of the state that the last evaluation liked most; the first of equals.
#[must_use]
pub fn best(particles: &Particles) -> (usize, f64) {
    largest(&particles.values())
}

/// Weighted mean state.
#[must_use]
pub fn aggregate(particles: &Particles) -> Vec<f64> {
    moments::mean(&particles.states, particles.dim, &particles.weights)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::transition::MotionModel;

    struct Shift(f64);
    impl MotionModel for Shift {
        fn dim(&self) -> usize {
            2
        }
    }

    impl Transition for Shift {
        fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut sinew_core::random::BlockRng) {
            rng.fill_uniform(next);
            for (n, p) in next.iter_mut().flat_map(|b| &mut b.0).zip(previous.iter().flat_map(|b| b.0)) {
                *n += p + self.0;
            }
        }
        fn log_density(&self, _previous: &[f64], _next: &[f64]) -> f64 {
            0.0
        }
    }

    struct Ramp;
    impl LogDensity for Ramp {
        fn dim(&self) -> usize {
            2
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            -10.0 * x[0]
        }
    }

    struct Nowhere;
    impl LogDensity for Nowhere {
        fn dim(&self) -> usize {
            2
        }
        fn log_density(&self, _x: &[f64]) -> f64 {
            f64::NEG_INFINITY
        }
    }

    fn moved() -> Particles {
        let mut particles = Particles::new(&[0.0, 5.0], 19).expect("not empty");
        start(&mut particles, &Shift(0.0), &[0.0, 5.0], Stage::new(1, "start"));
        predict(&mut particles, None, &Shift(1.0), Stage::new(1, "predict"));
        particles
    }

    #[test]
    fn states_follow_their_ancestors_and_can_retreat() {
        let mut particles = moved();
        let evidence = reweight(&mut particles, &Ramp).expect("finite");
        let expected: f64 =
            particles.states.chunks(2).flat_map(|b| b[0].0).take(19).map(|x| (-10.0 * x).exp() / 19.0).sum();
        assert!((evidence - expected.ln()).abs() < 1e-12);
        assert!((particles.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let before = particles.clone();
        let ancestors = resample(&particles, Scheme::Systematic, Stage::new(1, "resample"));
        predict(&mut particles, Some(ancestors.clone()), &Shift(1.0), Stage::new(1, "again"));
        assert_eq!(particles.effective_sample_size().round(), 19.0);
        for (i, &ancestor) in ancestors.iter().enumerate() {
            assert_eq!(particles.ancestor(i), ancestor);
            for j in 0..2 {
                let old = particles.previous[ancestor / 8 * 2 + j].0[ancestor % 8];
                let step = particles.states[i / 8 * 2 + j].0[i % 8] - old;
                assert!((1.0..2.0).contains(&step), "a state and its ancestor belong together: {step}");
            }
        }
        assert!(aggregate(&particles)[1] > 7.0);
        retreat(&mut particles);
        assert_eq!(particles.states, before.states);
        assert_eq!(particles.log_weights, before.log_weights);
        assert!(particles.weights.iter().zip(&before.weights).all(|(a, b)| (a - b).abs() < 1e-14));
    }

    #[test]
    fn nothing_explained_is_an_error_and_changes_nothing() {
        let mut particles = moved();
        let before = particles.weights.clone();
        assert_eq!(reweight(&mut particles, &Nowhere), Err(Error::AllWeightsZero { count: 19 }));
        assert_eq!(particles.weights, before);
        assert!(Particles::new(&[], 3).is_err() && Particles::new(&[1.0], 0).is_err());
    }
}
