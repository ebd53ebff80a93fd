//! The draws of a frame, moved to where they would be for each draw of what is constant.

use crate::posterior::Posterior;
use sinew_core::estimators::mean;
use sinew_core::lanes::{Block, LANES, numbers, numbers_mut};
use sinew_core::random::BlockRng;

/// Weighted draws are made this many of equal weight before they are moved.
const EQUAL_DRAWS: usize = 512;

/// Rows of some draws of what is constant, each in as many blocks as they need.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Blocks of the rows, one row after the other.
    pub values: Vec<Block>,
    /// Draws n.
    pub draws: usize,
}

impl Rows {
    /// From rows of numbers, one after the other.
    #[must_use]
    pub fn new(rows: &[f64], draws: usize) -> Self {
        let blocks = draws.div_ceil(LANES);
        let mut values = vec![Block::ZERO; rows.len() / draws.max(1) * blocks];
        for (own, row) in values.chunks_exact_mut(blocks.max(1)).zip(rows.chunks_exact(draws.max(1))) {
            numbers_mut(own)[..draws].copy_from_slice(row);
        }
        Self { values, draws }
    }

    /// Blocks of a row.
    #[must_use]
    pub const fn blocks(&self) -> usize {
        self.draws.div_ceil(LANES)
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks_exact(self.blocks().max(1)).map(|row| &numbers(row)[..self.draws])
    }

    /// One of them.
    #[must_use]
    pub fn row(&self, index: usize) -> &[f64] {
        &numbers(&self.values[index * self.blocks()..][..self.blocks()])[..self.draws]
    }

    /// The numbers, row after row.
    #[must_use]
    pub fn numbers(&self) -> Vec<f64> {
        self.rows().flatten().copied().collect()
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn is_zero(&self) -> bool {
        self.values.iter().all(|block| *block == Block::ZERO)
    }

    /// Adds draw k of each row to number k, k + n, … of a column of `out`, which has a column for each row.
    pub fn add_columns(&self, out: &mut [f64]) {
        let width = self.values.len() / self.blocks().max(1);
        for (column, row) in self.rows().enumerate() {
            for some in out.chunks_mut(width * self.draws) {
                some[column..].iter_mut().step_by(width).zip(row).for_each(|(x, by)| *x += by);
            }
        }
    }
}

/// Adds to each number of a series what its draw has in a row; draws repeat.
pub fn add_row(series: &mut [f64], row: &[f64]) {
    for some in series.chunks_mut(row.len()) {
        some.iter_mut().zip(row).for_each(|(x, by)| *x += by);
    }
}

/// Where the draws of a frame go.
#[derive(Clone, Debug, PartialEq)]
pub struct Moved {
    /// The part of it that all points share in all frames, draw by draw, metres.
    pub shifts: Vec<[f64; 3]>,
    /// By how much each moves the state: a row for each degree of freedom.
    pub states: Rows,
    /// By how much each moves the points of the body beyond that: three rows a point, metres.
    pub points: Rows,
    /// The same of the keypoints as the detectors see them.
    pub keypoints: Rows,
}

/// Draws of equal weight.
#[derive(Clone, Debug)]
pub struct EqualDraws {
    /// Their states, a block for each eight.
    pub states: Vec<Block>,
    /// Their weights.
    pub weights: Vec<f64>,
}

impl Moved {
    /// Mean move of the state.
    #[must_use]
    pub fn mean(&self) -> Vec<f64> {
        self.states.rows().map(mean).collect()
    }

    /// Shape and detected keypoints of the first draws, as they are written; `at` are the keypoints of the body in their moved states, draw after draw.
    #[must_use]
    pub fn written(&self, mut at: Vec<f64>, count: usize) -> [Vec<f64>; 2] {
        let mut shape = vec![0.0; count * self.points.rows().count()];
        self.points.add_columns(&mut shape);
        self.keypoints.add_columns(&mut at);
        [shape, at]
    }

    /// Moves some states, one after the other, the k-th as draw k says.
    pub fn apply(&self, states: &mut [f64]) {
        self.states.add_columns(states);
    }

    /// The draws of a posterior, of equal weight and moved.
    #[must_use]
    pub fn equal_draws(&self, posterior: &Posterior<'_>, rng: &mut BlockRng) -> EqualDraws {
        let (d, draws) = (posterior.dim, self.states.draws);
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
            let first = block * LANES % draws;
            for (x, row) in state.iter_mut().zip(self.states.rows()) {
                let by = row[first..].iter().chain(row.iter().cycle());
                x.0.iter_mut().zip(by).for_each(|(x, by)| *x += by);
            }
        }
        let count = if is_equal { posterior.count() } else { EQUAL_DRAWS };
        EqualDraws { states, weights: vec![1.0 / count as f64; count] }
    }
}
