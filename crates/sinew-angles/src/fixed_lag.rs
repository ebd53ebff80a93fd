//! The posterior of a change: draws of an earlier frame, each jointly with a draw of the present one.
//!
//! Filtered draws of neighbouring frames are not joint draws: their difference would have the variance of both. Given a state s_t, the frames up to t say of the state before no more
//! than s_t and the frames up to t − 1 do, so one step of a backward pass ([`sinew_dynamics::smoother`]) makes of each draw of frame t a draw of the pair. With moments (m, P) of
//! the filter at t − 1, widened by what persistent errors add, and steps of covariance Q,
//!
//! ```text
//! G = P (P + Q)⁻¹        s_{t−1} = m + G (s_t − m) + N(0, P − G P)
//! ```
//!
//! and again for t − 2, …. What lasts is in it as in a backward pass over a whole run: where a draw of what is constant moves the filtered states by Δ_t and Δ_{t−1}, it moves the pair by Δ_t and
//! Δ_{t−1} + G (Δ_t − Δ_{t−1}). Errors that persist some frames are taken for independent given the states, which makes changes wider than they are, never narrower.
//!
//! The rate of an angle is its mean rate over `WINDOW_S`, two frames at 30 a second: shorter differences show noise, longer ones hide how fast a movement was. Steps back are made once for each frame, so that the cost of a frame grows with the
//! frames of the window by products of matrices with draws only.

use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::Moments;
use sinew_dynamics::Error;
use sinew_dynamics::smoother::{BackwardStep, Smoother};
use sinew_tracking::posterior::Posterior;
use std::collections::VecDeque;

use crate::marginals::{AngleChange, LaterFrame};

/// Time over which a change is looked at, seconds; at least two frames.
const WINDOW_S: f64 = 1.0 / 15.0;

/// Draws of which changes are made, at most.
const DRAWS: usize = 256;

/// Frames of half a window.
#[must_use]
pub fn half_window(fps: f64) -> usize {
    ((0.5 * WINDOW_S * fps).round() as usize).max(1)
}

/// What is kept of a frame.
struct Filtered {
    moments: Moments,
    /// By how much draws of what is constant move it, dimension × draws, row after row.
    moves: Vec<f64>,
    /// The step back to it.
    step: BackwardStep,
}

/// The filter's last frames.
pub struct FixedLag {
    smoother: Smoother,
    dim: usize,
    frames: usize,
    fps: f64,
    isa: Isa,
    /// The latest frame last.
    past: VecDeque<Filtered>,
}

impl FixedLag {
    /// Before the first frame of a walk with these standard deviations of a step.
    #[must_use]
    pub fn new(step_sd: &[f64], fps: f64, isa: Isa) -> Self {
        let frames = 2 * half_window(fps);
        Self { smoother: Smoother::random_walk(step_sd), dim: step_sd.len(), frames, fps, isa, past: VecDeque::new() }
    }

    /// Tracking begins again: former frames say nothing of the next.
    pub fn restart(&mut self) {
        self.past.clear();
    }

    /// Some draws of the present frame with theirs of the one at the beginning of the window; `moves` is in the draws. None where there is no frame before.
    ///
    /// # Errors
    /// Moves of another size than those before.
    pub fn change(&self, now: &Posterior<'_>, moves: &[f64], stage: Stage) -> Result<Option<AngleChange>, Error> {
        if self.past.is_empty() {
            return Ok(None);
        }
        let mut rng = stage.whole();
        let (mut earlier, indices) = equal_draws(now, &mut rng);
        self.shift(&mut earlier, moves, &indices, -1.0);
        let mut moves = moves.to_vec();
        for frame in self.past.iter().rev() {
            frame.step.sample(&mut earlier, self.isa, &mut rng);
            if !moves.is_empty() {
                moves = frame.step.changes(&frame.moves, &moves)?;
            }
        }
        self.shift(&mut earlier, &moves, &indices, 1.0);
        Ok(Some(AngleChange {
            earlier,
            later: LaterFrame::Present(indices),
            seconds: self.past.len() as f64 / self.fps,
        }))
    }

    /// Adds the moves of their draws to some states.
    fn shift(&self, states: &mut [Block], moves: &[f64], indices: &[usize], sign: f64) {
        let draws = moves.len() / self.dim;
        if draws == 0 {
            return;
        }
        for (state, indices) in states.chunks_exact_mut(self.dim).zip(indices.chunks_exact(LANES)) {
            for (x, row) in state.iter_mut().zip(moves.chunks_exact(draws)) {
                x.0.iter_mut().zip(indices).for_each(|(x, draw)| *x += sign * row[draw % draws]);
            }
        }
    }

    /// Takes in a frame: its moments, widened by what persistent errors add, and its moves.
    ///
    /// # Errors
    /// A covariance that cannot be factored.
    pub fn push(&mut self, moments: Moments, moves: Vec<f64>) -> Result<(), Error> {
        let step = self.smoother.backward(&moments)?;
        self.past.push_back(Filtered { moments, moves, step });
        if self.past.len() > self.frames {
            self.past.pop_front();
        }
        Ok(())
    }

    /// What [`FixedLag::restore`] takes.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        let numbers = |frame: &Filtered| [&frame.moments.mean[..], &frame.moments.covariance, &frame.moves].concat();
        self.past.iter().flat_map(numbers).collect()
    }

    /// Continues where another stood, with as many draws of what is constant; false for numbers of another size.
    pub fn restore(&mut self, saved: &[f64], lasting_draws: usize) -> bool {
        let (d, frame) = (self.dim, self.dim * (1 + self.dim + lasting_draws));
        if !saved.len().is_multiple_of(frame) || saved.len() > self.frames * frame {
            return false;
        }
        let filtered = |numbers: &[f64]| {
            let (mean, rest) = numbers.split_at(d);
            let (covariance, moves) = rest.split_at(d * d);
            let moments = Moments { mean: mean.to_vec(), covariance: covariance.to_vec() };
            let step = self.smoother.backward(&moments).ok()?;
            Some(Filtered { moments, moves: moves.to_vec(), step })
        };
        let past: Option<VecDeque<Filtered>> = saved.chunks_exact(frame).map(filtered).collect();
        let is_whole = past.is_some();
        self.past = past.unwrap_or_default();
        is_whole
    }
}

/// States of draws of equal weight, at most [`DRAWS`], in whole blocks, and the index of each among the draws.
fn equal_draws(posterior: &Posterior<'_>, rng: &mut BlockRng) -> (Vec<Block>, Vec<usize>) {
    let (d, blocks) = (posterior.dim, posterior.count() / LANES);
    if blocks > 0 && posterior.weights.windows(2).all(|pair| pair[0] == pair[1]) {
        let every = blocks.div_ceil(DRAWS / LANES);
        let chosen = || (0..blocks).step_by(every);
        let states = chosen().flat_map(|block| &posterior.states[block * d..][..d]).copied().collect();
        return (states, chosen().flat_map(|block| block * LANES..(block + 1) * LANES).collect());
    }
    let indices = posterior.equal_weight(DRAWS, rng).to_vec();
    let mut states = vec![Block::ZERO; DRAWS / LANES * d];
    for (draw, &index) in indices.iter().enumerate() {
        for j in 0..d {
            states[draw / LANES * d + j].0[draw % LANES] = posterior.states[index / LANES * d + j].0[index % LANES];
        }
    }
    (states, indices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::lanes::numbers;

    fn stage(frame: u32) -> Stage {
        Stage::new(3, "rates of change").at_frame(frame)
    }

    /// Of weighted states of two coordinates: as often as their weights say, and each with both of its own.
    #[test]
    fn weighted_states_are_drawn_whole() {
        let count = 5 * LANES;
        let mut states = vec![Block::ZERO; 2 * count / LANES];
        for k in 0..count {
            let first = k / LANES * 2;
            states[first].0[k % LANES] = k as f64;
            states[first + 1].0[k % LANES] = -(k as f64);
        }
        let total: f64 = (0..count).map(|k| k as f64).sum();
        let weights: Vec<f64> = (0..count).map(|k| k as f64 / total).collect();
        let posterior = Posterior { dim: 2, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let (drawn, indices) = equal_draws(&posterior, &mut stage(0).whole());
        assert_eq!((drawn.len(), indices.len()), (2 * DRAWS / LANES, DRAWS));
        for (draw, index) in indices.iter().enumerate() {
            let [a, b] = [0, 1].map(|j| drawn[draw / LANES * 2 + j].0[draw % LANES]);
            assert_eq!([a, b], [*index as f64, -(*index as f64)]);
        }
        // The mean index under these weights: Σk² / Σk = (2 n − 1) / 3.
        let mean = indices.iter().sum::<usize>() as f64 / DRAWS as f64;
        assert!((mean - (2 * count - 1) as f64 / 3.0).abs() < 2.0, "{mean}");
    }

    /// A walk of one coordinate with steps of 0.5, observed with errors of 1, of which the filter is exact: variances of a change over two frames, by the joint Gaussian of both ends.
    #[test]
    fn changes_have_the_variance_of_the_joint_posterior() {
        let (q, r) = (0.25, 1.0);
        let mut lag = FixedLag::new(&[0.5], 30.0, Isa::baseline());
        let (mut mean, mut variance) = (0.0, 4.0);
        let observations = [0.3, -0.4, 1.9];
        let mut filtered = vec![];
        for (frame, y) in observations.into_iter().enumerate() {
            if frame > 0 {
                variance += q;
            }
            let gain = variance / (variance + r);
            mean += gain * (y - mean);
            variance *= 1.0 - gain;
            filtered.push([mean, variance]);
            if frame < 2 {
                lag.push(Moments { mean: vec![mean], covariance: vec![variance] }, vec![]).unwrap();
            }
        }
        // Of the pair (s_0, s_2) given all three observations, by conditioning a Gaussian of three states.
        let [[m0, p0], [m1, p1], [m2, p2]] = filtered[..] else { panic!() };
        let (g1, g0) = (p1 / (p1 + q), p0 / (p0 + q));
        let s1 = [m1 + g1 * (m2 - m1), p1 + g1 * g1 * (p2 - p1 - q)];
        let s0 = [m0 + g0 * (s1[0] - m0), p0 + g0 * g0 * (s1[1] - p0 - q)];
        let expected = [m2 - s0[0], p2 + s0[1] - 2.0 * g0 * g1 * p2];
        let count = 4096;
        let mut rng = Stage::new(5, "test").at_frame(0).whole();
        let mut states = vec![Block::ZERO; count / LANES];
        rng.fill_normal(Isa::baseline(), &mut states);
        states.iter_mut().for_each(|block| block.0.iter_mut().for_each(|x| *x = m2 + p2.sqrt() * *x));
        let weights = vec![1.0 / count as f64; count];
        let [mut sum, mut squares, mut total] = [0.0; 3];
        for number in 0..40 {
            let now = Posterior { dim: 1, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
            let AngleChange { earlier, later, seconds } = lag.change(&now, &[], stage(number)).unwrap().unwrap();
            let LaterFrame::Present(draws) = later else { panic!() };
            assert!((seconds - 2.0 / 30.0).abs() < 1e-15 && draws.len() == DRAWS);
            for (a, b) in numbers(&earlier).iter().zip(draws.iter().map(|draw| numbers(&states)[*draw])) {
                sum += b - a;
                squares += (b - a - expected[0]).powi(2);
                total += 1.0;
            }
        }
        // The draws of the present frame are the same 256 every time, and vary by themselves.
        assert!((sum / total - expected[0]).abs() < 0.15, "{} for {}", sum / total, expected[0]);
        assert!((squares / total / expected[1] - 1.0).abs() < 0.15, "{} for {}", squares / total, expected[1]);
        // Differences of draws that do not belong together have another variance.
        assert!((p0 + p2) / expected[1] > 1.4, "{} {}", p0 + p2, expected[1]);
    }

    /// A constant error moves both ends of a change alike: nothing of it is left in the change.
    #[test]
    fn a_move_of_all_frames_alike_is_no_change() {
        let mut lag = FixedLag::new(&[0.5], 30.0, Isa::baseline());
        let moves: Vec<f64> = (0..8).map(|draw| 10.0 * f64::from(draw)).collect();
        lag.push(Moments { mean: vec![0.0], covariance: vec![1e-12] }, moves.clone()).unwrap();
        let states = [Block(std::array::from_fn(|lane| 10.0 * lane as f64))];
        let weights = [0.125; 8];
        let now = Posterior { dim: 1, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let AngleChange { earlier, .. } = lag.change(&now, &moves, stage(7)).unwrap().unwrap();
        assert!(numbers(&earlier).iter().zip(numbers(&states)).all(|(a, b)| (a - b).abs() < 1e-4));
        // The same numbers again from what was saved.
        let saved = lag.save();
        let mut again = FixedLag::new(&[0.5], 30.0, Isa::baseline());
        assert!(!again.restore(&saved, 7) && again.restore(&saved, 8));
        assert_eq!(again.change(&now, &moves, stage(7)).unwrap().unwrap().earlier, earlier);
        lag.restart();
        assert!(lag.change(&now, &moves, stage(7)).unwrap().is_none());
    }
}
