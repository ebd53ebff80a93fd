//! Numbers of any count from a block generator; bits do not depend on the processor.

use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;

fn filled(count: usize, fill: impl FnOnce(&mut [Block])) -> Vec<f64> {
    let mut blocks = vec![Block::ZERO; count.div_ceil(LANES)];
    fill(&mut blocks);
    blocks.iter().flat_map(|block| block.0).take(count).collect()
}

/// Independent standard normal deviates.
#[must_use]
pub fn normals(count: usize, rng: &mut BlockRng) -> Vec<f64> {
    filled(count, |blocks| rng.fill_normal(Isa::baseline(), blocks))
}

/// Independent uniform numbers in (0, 1).
#[must_use]
pub fn uniforms(count: usize, rng: &mut BlockRng) -> Vec<f64> {
    filled(count, |blocks| rng.fill_uniform(blocks))
}

/// One uniform number in (0, 1).
#[must_use]
pub fn uniform(rng: &mut BlockRng) -> f64 {
    uniforms(1, rng)[0]
}

/// One of 0 … `below` − 1, all equally likely to 2⁻³².
pub(crate) fn index(below: usize, rng: &mut BlockRng) -> usize {
    ((uniform(rng) * below as f64) as usize).min(below - 1)
}
