//! A particle filter's first frame: draws from the prior, weighted by the likelihood (Choo & Fleet 2001, §3). The draws are made and forgotten block by block, so that millions need no memory.

use super::problem::Problem;
use sinew::core::density::LogDensity as _;
use sinew::core::lanes::{Block, LANES};
use sinew::core::random::Stage;
use sinew::core::transition::Transition as _;

/// Running sums of weights relative to the largest so far.
#[derive(Clone, Debug)]
pub(super) struct Weighted {
    largest: f64,
    sum: f64,
    squares: f64,
    first: Vec<f64>,
    /// Lower triangle of the second moments; empty where they are not wanted.
    second: Vec<f64>,
}

impl Weighted {
    fn new(dim: usize, moments: bool) -> Self {
        let second = if moments { vec![0.0; dim * (dim + 1) / 2] } else { vec![] };
        Self { largest: f64::NEG_INFINITY, sum: 0.0, squares: 0.0, first: vec![0.0; dim], second }
    }

    fn rescale(&mut self, largest: f64) {
        let factor = (self.largest - largest).exp();
        self.sum *= factor;
        self.squares *= factor * factor;
        self.first.iter_mut().chain(&mut self.second).for_each(|x| *x *= factor);
        self.largest = largest;
    }

    /// Adds the first `count` lanes of a block of states; `origin` keeps second moments from cancelling.
    fn add(&mut self, states: &[Block], log_weights: Block, count: usize, origin: &[f64]) {
        let largest = log_weights.0[..count].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if largest > self.largest {
            self.rescale(largest);
        }
        if self.largest == f64::NEG_INFINITY {
            return;
        }
        let mut weights = [0.0; LANES];
        for (w, l) in weights.iter_mut().zip(log_weights.0).take(count) {
            *w = (l - self.largest).exp();
            self.sum += *w;
            self.squares += *w * *w;
        }
        let weighted = |x: &Block, origin: f64| {
            let mut out = [0.0; LANES];
            (0..LANES).for_each(|lane| out[lane] = weights[lane] * (x.0[lane] - origin));
            out
        };
        let mut entries = self.second.iter_mut();
        for (i, (x, sum)) in states.iter().zip(&mut self.first).enumerate() {
            let moved = weighted(x, origin[i]);
            *sum += moved.iter().sum::<f64>();
            if entries.len() > 0 {
                for (j, y) in states[..=i].iter().enumerate() {
                    if let Some(entry) = entries.next() {
                        *entry += (0..LANES).map(|lane| moved[lane] * (y.0[lane] - origin[j])).sum::<f64>();
                    }
                }
            }
        }
    }

    fn merge(&mut self, mut other: Self) {
        if other.largest > self.largest {
            self.rescale(other.largest);
        } else {
            other.rescale(self.largest);
        }
        self.sum += other.sum;
        self.squares += other.squares;
        self.first.iter_mut().zip(other.first).for_each(|(a, b)| *a += b);
        self.second.iter_mut().zip(other.second).for_each(|(a, b)| *a += b);
    }

    /// Weighted mean.
    pub(super) fn mean(&self, origin: &[f64]) -> Vec<f64> {
        self.first.iter().zip(origin).map(|(x, origin)| origin + x / self.sum).collect()
    }

    /// Weighted covariance, row after row.
    pub(super) fn covariance(&self) -> Vec<f64> {
        let d = self.first.len();
        let mut out = vec![0.0; d * d];
        let mut entries = self.second.iter();
        for i in 0..d {
            for (j, entry) in (0..=i).zip(entries.by_ref()) {
                let value = entry / self.sum - self.first[i] * self.first[j] / (self.sum * self.sum);
                (out[i * d + j], out[j * d + i]) = (value, value);
            }
        }
        out
    }

    /// Effective number of draws, 1 / Σ W².
    pub(super) fn effective(&self) -> f64 {
        self.sum * self.sum / self.squares
    }
}

/// Weighs `count` draws of the prior; `moments` asks for the covariance too.
pub(super) fn weigh(problem: &Problem, count: usize, moments: bool, stage: &Stage) -> Weighted {
    let d = problem.previous.len();
    let mut all = Weighted::new(d, moments);
    let mut states = vec![Block::ZERO; d];
    let mut ws = vec![Block::ZERO; problem.likelihood.workspace()];
    for block in 0..count.div_ceil(LANES) {
        problem.walk.sample_initial_block(&problem.previous, &mut states, &mut stage.block(block as u32));
        let log_weights = problem.likelihood.log_density_block(&states, &mut ws);
        all.add(&states, log_weights, (count - block * LANES).min(LANES), &problem.previous);
    }
    all
}

/// The same from many independent parts of `count` draws in parallel.
pub(super) fn weigh_parts(problem: &Problem, count: usize, parts: usize, stage: &Stage) -> Weighted {
    use rayon::prelude::*;
    let part = |part: usize| weigh(problem, count, true, &stage.round(part));
    let all: Vec<Weighted> = (0..parts).into_par_iter().map(part).collect();
    let mut sum = Weighted::new(problem.previous.len(), true);
    all.into_iter().for_each(|part| sum.merge(part));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two coordinates of twelve draws in two blocks, the last four lanes idle, and their log weights.
    fn draws() -> ([[Block; 2]; 2], [Block; 2]) {
        let state = |b: usize, j: usize| Block(std::array::from_fn(|lane| ((8 * b + lane + 3 * j) as f64 * 0.7).sin()));
        let weight = |b: usize| Block(std::array::from_fn(|lane| -600.0 + 90.0 * ((8 * b + lane) as f64).cos()));
        ([0, 1].map(|b| [state(b, 0), state(b, 1)]), [0, 1].map(weight))
    }

    #[test]
    fn running_sums_equal_the_sums_over_all() {
        let (states, log_weights) = draws();
        let origin = [0.3, -0.2];
        let place = |i: usize| (i / LANES, i % LANES);
        let largest = (0..12).map(|i| log_weights[place(i).0].0[place(i).1]).fold(f64::MIN, f64::max);
        let weight = |i: usize| (log_weights[place(i).0].0[place(i).1] - largest).exp();
        let x = |i: usize, j: usize| states[place(i).0][j].0[place(i).1];
        let total: f64 = (0..12).map(weight).sum();
        let mean = [0, 1].map(|j| (0..12).map(|i| weight(i) * x(i, j)).sum::<f64>() / total);
        let covariance = |j: usize, k: usize| {
            (0..12).map(|i| weight(i) * (x(i, j) - mean[j]) * (x(i, k) - mean[k])).sum::<f64>() / total
        };
        let squares: f64 = (0..12).map(|i| (weight(i) / total).powi(2)).sum();

        let mut whole = Weighted::new(2, true);
        let mut parts = [Weighted::new(2, true), Weighted::new(2, true)];
        for b in 0..2 {
            let count = if b == 0 { 8 } else { 4 };
            whole.add(&states[b], log_weights[b], count, &origin);
            parts[b].add(&states[b], log_weights[b], count, &origin);
        }
        let [mut merged, second] = parts;
        merged.merge(second);
        for found in [whole, merged] {
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
            (0..2).for_each(|j| near(found.mean(&origin)[j], mean[j]));
            (0..4).for_each(|e| near(found.covariance()[e], covariance(e / 2, e % 2)));
            near(found.effective() * squares, 1.0);
        }
    }

    #[test]
    fn draws_that_explain_nothing_count_nothing() {
        let (states, log_weights) = draws();
        let mut some = Weighted::new(2, false);
        some.add(&states[0], Block::splat(f64::NEG_INFINITY), 8, &[0.0; 2]);
        some.add(&states[1], log_weights[1], 1, &[0.0; 2]);
        assert_eq!(some.mean(&[0.0; 2]), [states[1][0].0[0], states[1][1].0[0]]);
        assert_eq!(some.effective(), 1.0);
    }
}
