//! Draws of a run, from its `posterior.zarr`, and where truths lie among them.

use crate::support::outcome::Outcome;
use sinew::predict;
use std::path::Path;

/// A variable: numbers of each draw and frame.
pub(super) struct Drawn {
    values: Vec<f64>,
    pub(super) draws: usize,
    pub(super) frames: usize,
    width: usize,
}

impl Drawn {
    /// Reads a variable of a result folder.
    pub(super) fn read(folder: &Path, variable: &str) -> Outcome<Self> {
        let array = predict::drawn(folder, variable)?;
        let [_, draws, frames, ref rest @ ..] = array.shape[..] else {
            return Err(format!("{variable} has the shape {:?}", array.shape).into());
        };
        Ok(Self { draws, frames, width: rest.iter().product(), values: array.values })
    }

    /// The numbers of a draw in a frame.
    pub(super) fn at(&self, draw: usize, frame: usize) -> &[f64] {
        &self.values[(draw * self.frames + frame) * self.width..][..self.width]
    }

    /// A point of a draw in a frame.
    pub(super) fn point(&self, draw: usize, frame: usize, point: usize) -> [f64; 3] {
        let at = &self.at(draw, frame)[3 * point..];
        [at[0], at[1], at[2]]
    }

    /// The rank of a true number among that of the draws.
    pub(super) fn rank(&self, truth: f64, from_draw: impl Fn(usize) -> f64) -> u32 {
        (0..self.draws).filter(|draw| from_draw(*draw) < truth).count() as u32
    }
}
