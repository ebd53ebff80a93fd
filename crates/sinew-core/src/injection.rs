//! A transition that now and then starts from one of given latents.
//!
//! Each of them is as probable as any other; a lost tracker may so find back.
//!
//! p(s' | s) = (1 − ε) T(s' | s) + (ε / K) Σ_k T(s' | s with θ_k for its latent coordinates), for a transition T and latents θ_1 … θ_K, for instance the latents of training poses. With ε = 0 it is T, to the bit.

use crate::Error;
use crate::lanes::{Block, LANES};
use crate::random::BlockRng;
use crate::transition::{MotionModel, Transition};
use core::ops::Range;

/// What is injected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Injection {
    /// Probability ε, of each state on its own.
    pub probability: f64,
    /// The latents, one after the other.
    pub latents: Vec<f64>,
}

/// The transition. Law `injection_is_a_mixture`: states are drawn from the density above.
#[derive(Clone, Debug, PartialEq)]
pub struct Injected<T> {
    motion: T,
    injection: Injection,
    latent: Range<usize>,
}

impl<T: MotionModel> Injected<T> {
    /// Injects into the coordinates `latent` of the states that `motion` moves.
    ///
    /// # Errors
    /// [`Error::Rows`] where the latents are no whole rows, or there is none to inject; [`Error::Probability`] outside 0 to 1.
    pub fn new(motion: T, injection: Injection, latent: Range<usize>) -> Result<Self, Error> {
        let (columns, entries) = (latent.len(), injection.latents.len());
        if !(0.0..=1.0).contains(&injection.probability) {
            return Err(Error::Probability { value: injection.probability });
        }
        if columns == 0 || !entries.is_multiple_of(columns) || (injection.probability > 0.0 && entries == 0) {
            return Err(Error::Rows { entries, columns });
        }
        Ok(Self { motion, injection, latent })
    }

    fn latents(&self) -> impl ExactSizeIterator<Item = &[f64]> {
        self.injection.latents.chunks_exact(self.latent.len())
    }
}

impl<T: MotionModel> MotionModel for Injected<T> {
    fn dim(&self) -> usize {
        self.motion.dim()
    }
    fn follow(&mut self, before: Option<&[f64]>, estimate: &[f64]) {
        self.motion.follow(before, estimate);
    }
    fn memory(&self) -> Vec<f64> {
        self.motion.memory()
    }
    fn recall(&mut self, memory: &[f64]) {
        self.motion.recall(memory);
    }
}

impl<T: Transition> Transition for Injected<T> {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let Injection { probability, latents } = &self.injection;
        if *probability == 0.0 {
            return self.motion.sample_block(previous, next, rng);
        }
        let (mut from, mut drawn, q) = (previous.to_vec(), [Block::ZERO; 2], self.latent.len());
        rng.fill_uniform(&mut drawn);
        for lane in (0..LANES).filter(|&lane| drawn[0].0[lane] < *probability) {
            let row = (drawn[1].0[lane] * self.latents().len() as f64) as usize;
            from[self.latent.clone()].iter_mut().zip(&latents[row * q..]).for_each(|(x, z)| x.0[lane] = *z);
        }
        self.motion.sample_block(&from, next, rng);
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        self.motion.sample_initial_block(centre, next, rng);
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let own = self.motion.log_density(previous, next);
        let probability = self.injection.probability;
        if probability == 0.0 {
            return own;
        }
        let mut from = previous.to_vec();
        let elsewhere = self.latents().map(|latent| {
            from[self.latent.clone()].copy_from_slice(latent);
            (probability / self.latents().len() as f64).ln() + self.motion.log_density(&from, next)
        });
        let terms: Vec<f64> = elsewhere.chain([(1.0 - probability).ln() + own]).collect();
        let largest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if largest == f64::NEG_INFINITY {
            return largest;
        }
        largest + terms.iter().map(|term| (term - largest).exp()).sum::<f64>().ln()
    }
}
