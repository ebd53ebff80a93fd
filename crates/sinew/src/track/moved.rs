//! The draws of a frame, moved to where they would be for each draw of what is constant.

use sinew_core::lanes::{Block, LANES};
use sinew_core::random::BlockRng;
use sinew_tracking::posterior::Posterior;

/// Weighted draws are made this many of equal weight before they are moved.
const EQUAL_DRAWS: usize = 512;

/// Where the draws of a frame go.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Moved {
    /// The part of it that all points share in all frames, draw by draw, metres.
    pub shifts: Vec<[f64; 3]>,
    /// Draws n of what is constant.
    pub draws: usize,
    /// By how much each moves the state, d × n, row after row.
    pub states: Vec<f64>,
    /// By how much each moves the points of the body beyond that, 3 a point, × n, metres.
    pub points: Vec<f64>,
    /// The same of the keypoints as the detectors see them.
    pub keypoints: Vec<f64>,
}

/// Draws of equal weight.
pub(super) struct EqualDraws {
    pub states: Vec<Block>,
    pub weights: Vec<f64>,
}

impl Moved {
    /// Mean move of the state.
    pub(super) fn mean(&self) -> Vec<f64> {
        self.states.chunks_exact(self.draws).map(|row| row.iter().sum::<f64>() / self.draws as f64).collect()
    }

    /// Shifts of the first draws, one after the other: of `shifts`, rows of the draws.
    fn for_draws(&self, shifts: &[f64], count: usize) -> Vec<f64> {
        let rows = shifts.chunks_exact(self.draws);
        (0..count).flat_map(|draw| rows.clone().map(move |row| row[draw % self.draws])).collect()
    }

    /// Shape and detected keypoints of the first draws, as they are written; `at` are the keypoints of the body in their moved states.
    pub(super) fn written(&self, at: impl Iterator<Item = f64>, count: usize) -> [Vec<f64>; 2] {
        let mut detected = self.for_draws(&self.keypoints, count);
        detected.iter_mut().zip(at).for_each(|(x, at)| *x += at);
        [self.for_draws(&self.points, count), detected]
    }

    /// Moves some states, one after the other, the k-th as draw k says.
    pub(super) fn apply(&self, states: &mut [f64], dim: usize) {
        for (draw, state) in states.chunks_exact_mut(dim).enumerate() {
            state.iter_mut().enumerate().for_each(|(j, x)| *x += self.states[j * self.draws + draw % self.draws]);
        }
    }

    /// The draws of a posterior, of equal weight and moved.
    pub(super) fn equal_draws(&self, posterior: &Posterior<'_>, rng: &mut BlockRng) -> EqualDraws {
        let d = posterior.dim;
        let is_equal = posterior.weights.windows(2).all(|pair| pair[0] == pair[1]);
        let mut states = if is_equal {
            posterior.states.to_vec()
        } else {
            let chosen = posterior.equal_weight(EQUAL_DRAWS, rng);
            let mut states = vec![Block::ZERO; EQUAL_DRAWS / LANES * d];
            for (draw, &index) in chosen.iter().enumerate() {
                for j in 0..d {
                    states[draw / LANES * d + j].0[draw % LANES] =
                        posterior.states[index / LANES * d + j].0[index % LANES];
                }
            }
            states
        };
        for (block, state) in states.chunks_exact_mut(d).enumerate() {
            for (j, x) in state.iter_mut().enumerate() {
                x.0.iter_mut()
                    .enumerate()
                    .for_each(|(lane, x)| *x += self.states[j * self.draws + (block * LANES + lane) % self.draws]);
            }
        }
        let count = if is_equal { posterior.count() } else { EQUAL_DRAWS };
        EqualDraws { states, weights: vec![1.0 / count as f64; count] }
    }
}
