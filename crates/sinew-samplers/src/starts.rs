//! Starting states of chains by importance resampling from a frame's prior (Choo & Fleet 2001, §5).
//!
//! 1. u_i ~ prior, i = 1 … M, from a mixture one a component; w_i = p(z | u_i)
//! 2. s_i = M draws with replacement from {u_i, w_i}
//!
//! The mean of the w_i estimates the evidence ∫ p(z | s) prior(s) ds without bias.

use crate::Error;
use crate::resample::multinomial;
use crate::weights::normalise;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, LANES};
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
    let mut proposed = vec![Block::ZERO; count.div_ceil(LANES) * d];
    let mut ws = vec![Block::ZERO; observed.workspace()];
    let mut log_weights = Vec::with_capacity(proposed.len() / d * LANES);
    for (block, states) in proposed.chunks_exact_mut(d).enumerate() {
        prior.sample_block(block, states, &mut to_draw.block(block as u32));
        log_weights.extend(observed.log_density_block(states, &mut ws).0);
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
