//! One camera cannot distinguish a small person from a tall one farther away.
//!
//! When the body and its place are both scaled by s about the centre C of a camera, `P' = C + s (P − C)`, no pixel moves: the likelihood says nothing about s, and its
//! posterior is its prior, `ln s ~ N(0, sd²)`. So each draw of a pose gets an independent s. It moves the root to `R' = C + s (R − C)` and makes the body s times as
//! large about it. The same draw has the same s in every frame, as a trajectory of the smoother must.

use super::stored::Setup;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::Stage;
use sinew_observe::Camera;

/// Sizes of a body that was not measured, before a camera.
#[derive(Clone, Debug)]
pub struct UnknownSize {
    centre: [f64; 3],
    sd: f64,
    seed: u64,
    /// Factor of each draw, in blocks like the draws.
    factors: Vec<Block>,
}

impl UnknownSize {
    /// `None` where the size of the body is known.
    #[must_use]
    pub fn of(setup: &Setup, cameras: &[Camera], seed: u64) -> Option<Self> {
        let camera = cameras.first().filter(|_| setup.size_sd > 0.0)?;
        Some(Self::with_sd(camera, setup.size_sd, seed))
    }

    /// Sizes with a standard deviation of `ln s` before a camera.
    #[must_use]
    pub fn with_sd(camera: &Camera, sd: f64, seed: u64) -> Self {
        Self { centre: camera.centre(), sd, seed, factors: vec![] }
    }

    /// Draws the factors of `blocks` blocks.
    pub fn prepare(&mut self, blocks: usize) {
        if self.factors.len() < blocks {
            self.factors.resize(blocks, Block::ZERO);
            Stage::new(self.seed, "size").whole().fill_normal(Isa::baseline(), &mut self.factors);
            self.factors.iter_mut().flat_map(|block| &mut block.0).for_each(|x| *x = (self.sd * *x).exp());
        }
    }

    /// Factor of a draw.
    #[must_use]
    pub fn factor(&self, draw: usize) -> f64 {
        self.factors[draw / LANES].0[draw % LANES]
    }

    /// Moves coordinate `axis` of a point of a draw away from the camera or towards it.
    #[must_use]
    pub fn place(&self, draw: usize, axis: usize, x: f64) -> f64 {
        let centre = self.centre[axis];
        centre + self.factor(draw) * (x - centre)
    }

    /// Moves the root of a state, its first three coordinates.
    pub fn place_root(&self, draw: usize, state: &mut [f64]) {
        state.iter_mut().take(3).enumerate().for_each(|(axis, x)| *x = self.place(draw, axis, *x));
    }
}
