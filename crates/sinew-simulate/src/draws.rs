//! Numbers of a random stage as plain vectors, the same on every processor.

use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;

/// Standard normal deviates of a numbered block of a stage.
#[must_use]
pub fn normals(stage: &Stage, block: u32, count: usize) -> Vec<f64> {
    let mut blocks = vec![Block::ZERO; count.div_ceil(LANES)];
    stage.block(block).fill_normal(Isa::baseline(), &mut blocks);
    flat(&blocks, count)
}

/// Uniform numbers in (0, 1) of a numbered block of a stage.
#[must_use]
pub fn uniforms(stage: &Stage, block: u32, count: usize) -> Vec<f64> {
    let mut blocks = vec![Block::ZERO; count.div_ceil(LANES)];
    stage.block(block).fill_uniform(&mut blocks);
    flat(&blocks, count)
}

fn flat(blocks: &[Block], count: usize) -> Vec<f64> {
    let mut numbers: Vec<f64> = blocks.iter().flat_map(|block| block.0).collect();
    numbers.truncate(count);
    numbers
}
