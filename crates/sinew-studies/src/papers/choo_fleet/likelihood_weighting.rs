//! Likelihood weighting: draws of a prior, weighted by a likelihood, as running sums.
//!
//! ```text
//! x_i ~ p(x | centre),   w_i = exp ℓ(x_i),   mean = Σ w_i x_i / Σ w_i
//! ```
//!
//! The first frame of a particle filter (Gordon, Salmond & Smith 1993) without the particles: draws are made and forgotten block by block, so that millions need no memory. Sums are relative to the
//! largest weight so far, and sums of independent parts can be merged.

use rayon::prelude::*;
use sinew::core::density::LogDensity;
use sinew::core::lanes::{Block, LANES};
use sinew::core::random::Stage;
use sinew::core::transition::Transition;

/// Running sums of weights and weighted states, relative to the largest weight so far.
#[derive(Clone, Debug)]
pub(super) struct WeightedSums {
    largest: f64,
    sum: f64,
    squares: f64,
    first: Vec<f64>,
    /// Lower triangle of the second moments; empty where they are not wanted.
    second: Vec<f64>,
}

impl WeightedSums {
    /// Of no states of a dimension; with second moments or without.
    pub(super) fn new(dim: usize, second_moments: bool) -> Self {
        let second = if second_moments { vec![0.0; dim * (dim + 1) / 2] } else { vec![] };
        Self { largest: f64::NEG_INFINITY, sum: 0.0, squares: 0.0, first: vec![0.0; dim], second }
    }

    fn rescale(&mut self, largest: f64) {
        let factor = (self.largest - largest).exp();
        self.sum *= factor;
        self.squares *= factor * factor;
        self.first.iter_mut().chain(&mut self.second).for_each(|x| *x *= factor);
        self.largest = largest;
    }

    /// Adds the first `count` lanes of a block of states; `origin` keeps second moments from cancelling and is the same in every call.
    pub(super) fn add(&mut self, states: &[Block], log_weights: Block, count: usize, origin: &[f64]) {
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

    /// Adds what another set of sums with the same origin has seen.
    pub(super) fn merge(&mut self, mut other: Self) {
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

    /// Weighted covariance, row after row; zeros without second moments.
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

/// Weighs `count` draws of the first frame's prior around `centre` by the likelihood; block b of eight draws has the stream of that number.
pub(super) fn weigh(
    likelihood: &impl LogDensity,
    prior: &impl Transition,
    centre: &[f64],
    (count, second_moments): (usize, bool),
    stage: &Stage,
) -> WeightedSums {
    let d = centre.len();
    let mut all = WeightedSums::new(d, second_moments);
    let mut states = vec![Block::ZERO; d];
    let mut ws = vec![Block::ZERO; likelihood.workspace()];
    for block in 0..count.div_ceil(LANES) {
        prior.sample_initial_block(centre, &mut states, &mut stage.block(block as u32));
        let log_weights = likelihood.log_density_block(&states, &mut ws);
        all.add(&states, log_weights, (count - block * LANES).min(LANES), centre);
    }
    all
}

/// Weighs `parts` times `count` draws, with second moments; parts run in parallel, each with its own round of the stage, and merge in order.
pub(super) fn weigh_parts(
    likelihood: &impl LogDensity,
    prior: &impl Transition,
    centre: &[f64],
    (count, parts): (usize, usize),
    stage: &Stage,
) -> WeightedSums {
    let part = |part: usize| weigh(likelihood, prior, centre, (count, true), &stage.round(part));
    let all: Vec<WeightedSums> = (0..parts).into_par_iter().map(part).collect();
    let mut sum = WeightedSums::new(centre.len(), true);
    all.into_iter().for_each(|part| sum.merge(part));
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::core::lanes::Isa;
    use sinew::core::random::BlockRng;
    use sinew::core::toy::Quadratic;
    use sinew::core::transition::MotionModel;

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

        let mut whole = WeightedSums::new(2, true);
        let mut parts = [WeightedSums::new(2, true), WeightedSums::new(2, true)];
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
        let mut some = WeightedSums::new(2, false);
        some.add(&states[0], Block::splat(f64::NEG_INFINITY), 8, &[0.0; 2]);
        some.add(&states[1], log_weights[1], 1, &[0.0; 2]);
        assert_eq!(some.mean(&[0.0; 2]), [states[1][0].0[0], states[1][1].0[0]]);
        assert_eq!(some.effective(), 1.0);
    }

    /// N(previous, 1) in two coordinates.
    struct Step;

    impl MotionModel for Step {
        fn dim(&self) -> usize {
            2
        }
    }

    impl Transition for Step {
        fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
            rng.fill_normal(Isa::baseline(), next);
            next.iter_mut().zip(previous).for_each(|(x, p)| x.0.iter_mut().zip(p.0).for_each(|(x, p)| *x += p));
        }
        fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
            previous.iter().zip(next).map(|(p, n)| -0.5 * (n - p) * (n - p)).sum()
        }
    }

    #[test]
    fn means_and_covariances_match_the_posterior() {
        // Prior N(c, 1), likelihood N(z, 1/3): posterior N((c + 3 z) / 4, 1/4). Four standard errors of 4096 effective draws.
        let likelihood = Quadratic { centre: vec![1.0, -1.0], precision: vec![3.0, 3.0] };
        let (centre, stage) = ([0.5, 0.0], Stage::new(5, "likelihood weighting"));
        let found = weigh_parts(&likelihood, &Step, &centre, (4096, 4), &stage);
        let tolerance = 4.0 * 0.5 / found.effective().sqrt();
        assert!(found.effective() > 4096.0, "{}", found.effective());
        for (mean, exact) in found.mean(&centre).into_iter().zip([0.875, -0.75]) {
            assert!((mean - exact).abs() < tolerance, "{mean} for {exact} ± {tolerance}");
        }
        for (entry, exact) in found.covariance().into_iter().zip([0.25, 0.0, 0.0, 0.25]) {
            assert!((entry - exact).abs() < tolerance, "{entry} for {exact} ± {tolerance}");
        }
    }

    #[test]
    fn idle_lanes_do_not_count() {
        let likelihood = Quadratic { centre: vec![1.0, -1.0], precision: vec![3.0, 3.0] };
        let flat = Quadratic { precision: vec![0.0; 2], ..likelihood.clone() };
        let stage = Stage::new(6, "idle lanes");
        assert_eq!(weigh(&flat, &Step, &[0.0; 2], (13, false), &stage).effective(), 13.0);
    }
}
