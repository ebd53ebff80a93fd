//! Starting states of chains: importance resampling, or scattered at random.
//!
//! Importance resampling is from a frame's prior (Choo & Fleet 2001, §5) or from the Laplace approximation of its posterior:
//!
//! 1. u_i ~ prior, i = 1 … M, from a mixture one a component; w_i = p(z | u_i)
//! 2. s_i = M draws with replacement from {u_i, w_i}
//!
//! The mean of the w_i estimates the evidence ∫ p(z | s) prior(s) ds without bias.

use crate::Error;
use crate::laplace::Laplace;
use crate::resample::multinomial;
use crate::weights::normalise;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_core::transition::FramePrior;

/// `count` starting states, in blocks whose idle lanes repeat them, and the logarithm of the mean weight.
///
/// # Errors
/// [`Error::Empty`], [`Error::AllWeightsZero`], [`Error::BadWeight`].
pub fn importance_starts<O: LogDensity + ?Sized, P: FramePrior>(
    observed: &O,
    prior: &P,
    count: usize,
    stage: Stage,
) -> Result<(Vec<Block>, f64), Error> {
    let d = prior.dim();
    if count == 0 || d == 0 {
        return Err(Error::Empty { count, dim: d });
    }
    let [to_draw, to_resample] = stage.split(["draw", "resample"]);
    let mut ws = vec![Block::ZERO; observed.workspace()];
    resampled(count, d, to_resample, |block, states| {
        prior.sample_block(block, states, &mut to_draw.block(block as u32));
        observed.log_density_block(states, &mut ws)
    })
}

/// The same from the Laplace approximation of the posterior: w_i = p(z | u_i) prior(u_i) / q(u_i), whose mean estimates the same evidence, with far less scatter where
/// the posterior is narrow.
///
/// # Errors
/// As [`importance_starts`].
pub fn laplace_starts<T: LogDensity + ?Sized>(
    target: &T,
    laplace: &Laplace,
    count: usize,
    isa: Isa,
    stage: Stage,
) -> Result<(Vec<Block>, f64), Error> {
    let d = target.dim();
    if count == 0 || d == 0 {
        return Err(Error::Empty { count, dim: d });
    }
    let [to_draw, to_resample] = stage.split(["draw", "resample"]);
    let mut ws = vec![Block::ZERO; target.workspace()];
    resampled(count, d, to_resample, |block, states| {
        let log_proposal = laplace.sample_block(isa, states, &mut to_draw.block(block as u32));
        let mut log_weight = target.log_density_block(states, &mut ws);
        for (w, q) in log_weight.0.iter_mut().zip(log_proposal.0) {
            *w -= q;
        }
        log_weight
    })
}

/// Draws until a start has a finite log density and gradient.
const TRIES: usize = 100;

/// `count` starting states, uniform within ± `half_width` in every coordinate, in blocks whose idle lanes are drawn alike; Stan's default has a half width of 2. A state whose log density or gradient is not finite is drawn again.
///
/// # Errors
/// [`Error::Empty`]; [`Error::BadStart`] after a hundred tries.
pub fn uniform_starts<T: GradLogDensity + ?Sized>(
    target: &T,
    half_width: f64,
    count: usize,
    stage: &Stage,
) -> Result<Vec<Block>, Error> {
    let d = target.dim();
    if count == 0 || d == 0 {
        return Err(Error::Empty { count, dim: d });
    }
    let mut starts = vec![Block::ZERO; count.div_ceil(LANES) * d];
    let (mut drawn, mut gradient) = (vec![Block::ZERO; d], vec![Block::ZERO; d]);
    let mut ws = vec![Block::ZERO; target.workspace()];
    for (block, starts) in starts.chunks_exact_mut(d).enumerate() {
        let mut rng = stage.block(block as u32);
        let mut missing = [true; LANES];
        let mut log_density = Block::ZERO;
        for _ in 0..TRIES {
            rng.fill_uniform(&mut drawn);
            drawn.iter_mut().flat_map(|b| &mut b.0).for_each(|x| *x = half_width * (2.0 * *x - 1.0));
            log_density = target.log_density_grad_block(&drawn, &mut gradient, &mut ws);
            for (lane, missing) in missing.iter_mut().enumerate().filter(|(_, missing)| **missing) {
                *missing = !(log_density.0[lane].is_finite() && gradient.iter().all(|g| g.0[lane].is_finite()));
                starts.iter_mut().zip(&drawn).for_each(|(start, x)| start.0[lane] = x.0[lane]);
            }
            if !missing.contains(&true) {
                break;
            }
        }
        if let Some(lane) = missing.iter().position(|&missing| missing) {
            return Err(Error::BadStart { lane, value: log_density.0[lane] });
        }
    }
    Ok(starts)
}

/// Proposes blocks of states with their log weights and draws `count` of them.
fn resampled(
    count: usize,
    d: usize,
    to_resample: Stage,
    mut propose: impl FnMut(usize, &mut [Block]) -> Block,
) -> Result<(Vec<Block>, f64), Error> {
    let mut proposed = vec![Block::ZERO; count.div_ceil(LANES) * d];
    let mut log_weights = Vec::with_capacity(proposed.len() / d * LANES);
    for (block, states) in proposed.chunks_exact_mut(d).enumerate() {
        log_weights.extend(propose(block, states).0);
    }
    let mut weights = Vec::new();
    let log_mean = normalise(&log_weights[..count], &mut weights)? - (count as f64).ln();
    let ancestors = multinomial(&weights, count, &mut to_resample.whole());
    let mut states = vec![Block::ZERO; proposed.len()];
    for slot in 0..log_weights.len() {
        let from = ancestors[slot % count];
        for j in 0..d {
            states[slot / LANES * d + j].0[slot % LANES] = proposed[from / LANES * d + j].0[from % LANES];
        }
    }
    Ok((states, log_mean))
}
