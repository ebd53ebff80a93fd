//! Weighted states in blocks of eight, and the verbs of a particle filter on them.
//!
//! [`Particles`] holds `count` states, dimension-major in blocks: state i is lane i mod 8 of block i / 8. The lanes of the last block beyond `count` are moved along and never counted. The states before
//! the last [`predict`] are kept as well, so that one [`resample`] moves both.
//!
//! A step of a bootstrap filter is [`resample`], [`predict`], [`reweight`], [`aggregate`]. Blocks are mapped in parallel, each with its own random stream; sums are taken in index order, so the thread count does not change a bit.

use crate::resample::Scheme;
use crate::weights::{effective_number, normalise};
use crate::{Error, moments};
use rayon::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::Transition;

/// Blocks that one task moves at least: some ten microseconds of work.
const BLOCKS_A_TASK: usize = 16;

/// A weighted set of states.
#[derive(Clone, Debug)]
pub struct Particles {
    dim: usize,
    count: usize,
    states: Vec<Block>,
    previous: Vec<Block>,
    log_weights: Vec<f64>,
    weights: Vec<f64>,
    spare: Vec<Block>,
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
        let states: Vec<Block> = (0..blocks).flat_map(|_| centre.iter().map(|&x| Block::splat(x))).collect();
        Ok(Self {
            dim,
            count,
            previous: states.clone(),
            spare: states.clone(),
            states,
            log_weights: vec![-(count as f64).ln(); count],
            weights: vec![1.0 / count as f64; count],
        })
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

    /// The states before the last [`predict`], stored alike.
    #[must_use]
    pub fn previous(&self) -> &[Block] {
        &self.previous
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

    /// Effective number of states.
    #[must_use]
    pub fn effective_sample_size(&self) -> f64 {
        effective_number(&self.weights)
    }
}

/// Draws all states of the first frame around `centre`.
pub fn start<T: Transition + ?Sized>(particles: &mut Particles, transition: &T, centre: &[f64], stage: Stage) {
    let dim = particles.dim;
    particles.states.par_chunks_mut(dim).with_min_len(BLOCKS_A_TASK).enumerate().for_each(|(block, states)| {
        transition.sample_initial_block(centre, states, &mut stage.block(block as u32));
    });
}

/// Moves every state by the transition; the old states become [`Particles::previous`].
pub fn predict<T: Transition + ?Sized>(particles: &mut Particles, transition: &T, stage: Stage) {
    let Particles { dim, states, previous, .. } = particles;
    std::mem::swap(states, previous);
    states.par_chunks_mut(*dim).zip(previous.par_chunks(*dim)).with_min_len(BLOCKS_A_TASK).enumerate().for_each(
        |(block, (next, previous))| {
            transition.sample_block(previous, next, &mut stage.block(block as u32));
        },
    );
}

/// Takes the last [`predict`] back.
pub fn retreat(particles: &mut Particles) {
    std::mem::swap(&mut particles.states, &mut particles.previous);
}

/// Multiplies the weights by the likelihood and normalises them. Returns log Σ W_i exp l_i, the evidence of the observation given the earlier ones.
///
/// # Errors
/// [`Error::AllWeightsZero`], [`Error::BadWeight`]; the weights are then those before the call.
pub fn reweight<D: LogDensity + ?Sized>(particles: &mut Particles, likelihood: &D) -> Result<f64, Error> {
    let Particles { dim, count, states, spare, log_weights, weights, .. } = particles;
    let values = &mut spare[..count.div_ceil(LANES)];
    values.par_iter_mut().zip(states.par_chunks(*dim)).with_min_len(BLOCKS_A_TASK).for_each_init(
        || vec![Block::ZERO; likelihood.workspace()],
        |ws, (value, states)| *value = likelihood.log_density_block(states, ws),
    );
    let updated: Vec<f64> = log_weights.iter().zip(values.iter().flat_map(|b| b.0)).map(|(w, l)| w + l).collect();
    let evidence = normalise(&updated, weights)?;
    log_weights.iter_mut().zip(updated).for_each(|(w, u)| *w = u - evidence);
    Ok(evidence)
}

/// Draws the states anew by their weights, which become equal.
pub fn resample(particles: &mut Particles, scheme: Scheme, stage: Stage) {
    let Particles { dim, count, states, previous, log_weights, weights, spare } = particles;
    let ancestors = scheme.ancestors(weights, *count, &mut stage.whole());
    for population in [states, previous] {
        spare.par_chunks_mut(*dim).zip(ancestors.par_chunks(LANES)).with_min_len(BLOCKS_A_TASK).for_each(
            |(new, ancestors)| {
                for (lane, &ancestor) in ancestors.iter().enumerate() {
                    let old = &population[ancestor / LANES * *dim..][..*dim];
                    for (new, old) in new.iter_mut().zip(old) {
                        new.0[lane] = old.0[ancestor % LANES];
                    }
                }
            },
        );
        std::mem::swap(population, spare);
    }
    log_weights.fill(-(*count as f64).ln());
    weights.fill(1.0 / *count as f64);
}

/// Weighted mean state.
#[must_use]
pub fn aggregate(particles: &Particles) -> Vec<f64> {
    moments::mean(&particles.states, particles.dim, &particles.weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Shift(f64);
    impl Transition for Shift {
        fn dim(&self) -> usize {
            2
        }
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
        predict(&mut particles, &Shift(1.0), Stage::new(1, "predict"));
        particles
    }

    #[test]
    fn resample_moves_both_populations_and_keeps_the_evidence() {
        let mut particles = moved();
        let evidence = reweight(&mut particles, &Ramp).expect("finite");
        let expected: f64 =
            particles.states.chunks(2).flat_map(|b| b[0].0).take(19).map(|x| (-10.0 * x).exp() / 19.0).sum();
        assert!((evidence - expected.ln()).abs() < 1e-12);
        assert!((particles.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        resample(&mut particles, Scheme::Systematic, Stage::new(1, "resample"));
        assert_eq!(particles.effective_sample_size().round(), 19.0);
        for (s, p) in particles.states.iter().zip(&particles.previous) {
            for lane in 0..3 {
                let step = s.0[lane] - p.0[lane];
                assert!((1.0..2.0).contains(&step), "a state and its previous one belong together: {step}");
            }
        }
        assert!(aggregate(&particles)[1] > 6.0);
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
