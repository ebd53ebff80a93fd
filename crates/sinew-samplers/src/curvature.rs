//! Curvature of a frame's posterior for the step sizes of Hamiltonian Monte Carlo, from the prior alone.
//!
//! Choo & Fleet (2001, eq. 17) scale coordinate j by the root of a state-independent curvature. Here h_j = E_{s ~ prior}[GN_jj(s)] + P_jj: the Gauss–Newton diagonal of the observation averaged over K draws
//! from the frame's prior, plus the diagonal of an upper bound of the prior's precision. It is made before the chains start and frozen for the frame: a value that depended on a chain's state would destroy reversibility.

use sinew_core::density::GaussNewton;
use sinew_core::lanes::Block;
use sinew_core::random::Stage;
use sinew_core::transition::FramePrior;

/// The curvature h_1 … h_d from `draws` draws (rounded up to blocks of eight). Draws at which an entry is not finite are left out of its average.
#[must_use]
pub fn curvature<O: GaussNewton + ?Sized, P: FramePrior>(
    observed: &O,
    prior: &P,
    draws: usize,
    stage: Stage,
) -> Vec<f64> {
    let d = prior.dim();
    let mut state = vec![Block::ZERO; d];
    let mut diagonal = vec![Block::ZERO; d];
    let mut ws = vec![Block::ZERO; observed.matrix_workspace()];
    let mut sums = vec![(0.0, 0.0); d];
    for block in 0..draws.div_ceil(8) {
        prior.sample_block(block, &mut state, &mut stage.block(block as u32));
        observed.gauss_newton_diagonal_block(&state, &mut diagonal, &mut ws);
        for ((sum, count), entries) in sums.iter_mut().zip(&diagonal) {
            for entry in entries.0.iter().filter(|h| h.is_finite()) {
                *sum += entry.max(0.0);
                *count += 1.0;
            }
        }
    }
    sums.iter().zip(prior.precision_diagonal()).map(|(&(sum, count), p)| sum / f64::max(count, 1.0) + p).collect()
}
