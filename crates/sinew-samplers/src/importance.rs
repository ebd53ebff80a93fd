//! Self-normalised importance sampling from the Laplace approximation of a frame's posterior.
//!
//! It is the particle filter's step with a proposal that has seen the observation.
//!
//! 1. s_i ~ q, i = 1 … N, with q about the mode and with the Gauss–Newton covariance G⁻¹ ([`crate::laplace`])
//! 2. w_i = p(z | s_i) prior(s_i) / q(s_i), and Σ W_i f(s_i) estimates the posterior mean of f; the mean of the w_i estimates the evidence without bias
//!
//! (Doucet, Godsill & Andrieu 2000, §II.D, call it local linearisation.) A Gaussian q has thinner tails than a posterior that is broader than its Gauss–Newton matrix says: the weights then have no bound and the
//! estimate may have no variance. A Student t of ν degrees of freedom ([`Tails::StudentT`]; Geweke 1989) bounds them wherever the prior's tails are Gaussian; it pays with a smaller effective number where
//! q was right.
//!
//! A proposal that misses the posterior shows in an effective number far below N. One that misses a whole mode does not: nothing that is drawn from q can show a place where q never is.

use crate::Error;
use crate::laplace::Laplace;
use crate::moments;
use crate::population::Population;
use crate::weights::{effective_number, normalise};
use core::f64::consts::PI;
use rayon::prelude::*;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};

/// Tails of the proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tails {
    /// Gaussian tails.
    Gaussian,
    /// The tails of a multivariate Student t with the matrix G⁻¹.
    StudentT {
        /// Degrees of freedom ν ≥ 1.
        degrees: u32,
    },
}

impl Default for Tails {
    fn default() -> Self {
        Self::StudentT { degrees: 7 }
    }
}

/// log Γ(k / 2) for k ≥ 1, from Γ(½) = √π, Γ(1) = 1 and Γ(x + 1) = x Γ(x).
fn ln_gamma_of_half(k: u32) -> f64 {
    let start = if k % 2 == 1 { 0.5 * PI.ln() } else { 0.0 };
    start + (1..k).rev().skip(1).step_by(2).map(|j| (0.5 * f64::from(j)).ln()).sum::<f64>()
}

impl Tails {
    /// Refuses what has no density.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for ν = 0.
    pub fn check(self) -> Result<(), Error> {
        match self {
            Self::StudentT { degrees: 0 } => {
                Err(Error::OutOfRange { name: "degrees of freedom", value: 0.0, expected: "must be at least 1" })
            }
            _ => Ok(()),
        }
    }

    /// Draws eight states about the mode and returns their log densities.
    pub(crate) fn sample_block(self, laplace: &Laplace, isa: Isa, out: &mut [Block], rng: &mut BlockRng) -> Block {
        let mut log_density = laplace.sample_block(isa, out, rng);
        let Self::StudentT { degrees } = self else { return log_density };
        let (d, nu, peak) = (laplace.mode.len() as u32, f64::from(degrees), laplace.log_peak());
        let constant = ln_gamma_of_half(degrees + d) - ln_gamma_of_half(degrees) - 0.5 * f64::from(d) * (0.5 * nu).ln();
        let mut normal = vec![Block::ZERO; degrees as usize];
        rng.fill_normal(isa, &mut normal);
        for lane in 0..LANES {
            let chi_square: f64 = normal.iter().map(|z| z.0[lane] * z.0[lane]).sum();
            let stretch = nu / chi_square;
            let square = stretch * 2.0 * (peak - log_density.0[lane]);
            for (x, mode) in out.iter_mut().zip(&laplace.mode) {
                x.0[lane] = mode + (x.0[lane] - mode) * stretch.sqrt();
            }
            log_density.0[lane] = peak + constant - 0.5 * (nu + f64::from(d)) * (square / nu).ln_1p();
        }
        log_density
    }
}

/// Weighted draws.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighted {
    /// The draws.
    pub population: Population,
    /// Their normalised weights.
    pub weights: Vec<f64>,
    /// Logarithm of the mean weight: the evidence.
    pub log_evidence: f64,
}

impl Weighted {
    /// Weighted mean.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        moments::mean(self.population.states(), self.population.dim(), &self.weights)
    }

    /// Effective number of draws.
    #[must_use]
    pub fn effective_sample_size(&self) -> f64 {
        effective_number(&self.weights)
    }
}

/// `count` draws from the proposal, weighted to `target`, the product of likelihood and prior.
///
/// # Errors
/// [`Error::Empty`], [`Error::OutOfRange`] for ν = 0, [`Error::AllWeightsZero`], [`Error::BadWeight`].
pub fn importance<T: LogDensity + ?Sized>(
    target: &T,
    laplace: &Laplace,
    tails: Tails,
    count: usize,
    isa: Isa,
    stage: &Stage,
) -> Result<Weighted, Error> {
    tails.check()?;
    let d = target.dim();
    let scratch = || (vec![Block::ZERO; d], vec![Block::ZERO; target.workspace()]);
    let draw = |(states, ws): &mut (Vec<Block>, Vec<Block>), block: usize| {
        let log_proposal = tails.sample_block(laplace, isa, states, &mut stage.block(block as u32));
        let mut log_weights = target.log_density_block(states, ws);
        log_weights.0.iter_mut().zip(log_proposal.0).for_each(|(w, q)| *w -= q);
        (states.clone(), log_weights)
    };
    let drawn: Vec<(Vec<Block>, Block)> = (0..count.div_ceil(LANES)).into_par_iter().map_init(scratch, draw).collect();
    let population = Population::from_blocks(d, count, |block, states| states.copy_from_slice(&drawn[block].0))?;
    let log_weights: Vec<f64> = drawn.iter().flat_map(|(_, w)| w.0).take(count).collect();
    let mut weights = Vec::new();
    let log_evidence = normalise(&log_weights, &mut weights)? - (count as f64).ln();
    Ok(Weighted { population, weights, log_evidence })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gamma_function_at_halves() {
        for (k, gamma) in [(1, PI.sqrt()), (2, 1.0), (3, 0.5 * PI.sqrt()), (4, 1.0), (7, 1.875 * PI.sqrt()), (10, 24.0)]
        {
            assert!((ln_gamma_of_half(k) - f64::ln(gamma)).abs() < 1e-13, "Γ({k}/2)");
        }
    }
}
