//! A pass backwards over filtered moments that draws trajectories, frame after frame.
//!
//! Draw *i* of every frame that one pass goes through belongs to trajectory *i* (Frühwirth-Schnatter 1994). The noise of a frame depends on seed and frame alone, so passes that begin in
//! different frames share it. Where a pass is cut, the frame before counts as a last one.

use crate::Error;
use crate::smoother::{BackwardStep, Smoother};
use sinew_core::lanes::{Block, Isa, LANES, get_lane, set_lane};
use sinew_core::random::Stage;
use sinew_core::transition::Moments;

/// Trajectories drawn.
pub const TRAJECTORIES: usize = 128;

/// Trajectories in a frame: the smoothed mean, the states one after the other, and the moves of the draws of what is constant.
pub type FrameNumbers = Vec<f64>;

/// Numbers of [`FrameNumbers`].
#[must_use]
pub const fn numbers_of_frame(dim: usize, lasting_draws: usize) -> usize {
    (1 + TRAJECTORIES + lasting_draws) * dim
}

/// States one after the other as blocks.
#[must_use]
pub fn state_blocks(numbers: &[f64], dim: usize) -> Vec<Block> {
    let mut states = vec![Block::ZERO; TRAJECTORIES / LANES * dim];
    for (i, state) in numbers.chunks_exact(dim).enumerate() {
        set_lane(&mut states[i / LANES * dim..][..dim], i % LANES, state);
    }
    states
}

/// What a filter left of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FilteredFrame<'a> {
    /// Filtered moments.
    pub moments: &'a Moments,
    /// By how much draws of what is constant move them, dimension × draws; empty without such draws.
    pub moves: &'a [f64],
    /// The step back to it.
    pub step: &'a BackwardStep,
    /// Whether nothing is known of the step to it from the frame before.
    pub is_cut: bool,
}

/// A pass backwards through filtered frames.
pub struct BackwardPass {
    states: Vec<Block>,
    /// Smoothed mean of the frame after, and moves of its draws; none where the pass begins, or begins again.
    next: Option<(Vec<f64>, Vec<f64>)>,
    seed: u64,
    isa: Isa,
}

impl BackwardPass {
    /// Before the last frame.
    #[must_use]
    pub fn new(dim: usize, seed: u64, isa: Isa) -> Self {
        Self { states: vec![Block::ZERO; TRAJECTORIES / LANES * dim], next: None, seed, isa }
    }

    /// Goes back to a frame, counted from the first of the run.
    ///
    /// # Errors
    /// A covariance that cannot be factored; moves of another size than those before.
    pub fn go_to(
        &mut self,
        frame: u64,
        filtered: FilteredFrame<'_>,
        smoother: &Smoother,
    ) -> Result<FrameNumbers, Error> {
        let Self { states, next, seed, isa } = self;
        let FilteredFrame { moments, moves, step, is_cut } = filtered;
        let rng = &mut Stage::new(*seed, "smooth").at_frame(frame as u32).whole();
        let (mean, moves) = match next {
            None => {
                smoother.sample_last(moments, states, *isa, rng)?;
                (moments.mean.clone(), moves.to_vec())
            }
            Some((mean, later)) => {
                let moves = if later.is_empty() { vec![] } else { step.changes(moves, later)? };
                step.sample(states, *isa, rng);
                (step.mean(mean), moves)
            }
        };
        let d = mean.len();
        let mut numbers = mean.clone();
        numbers.resize((1 + TRAJECTORIES) * d, 0.0);
        for (i, state) in numbers[d..].chunks_exact_mut(d).enumerate() {
            get_lane(&states[i / LANES * d..][..d], i % LANES, state);
        }
        numbers.extend(&moves);
        *next = if is_cut { None } else { Some((mean, moves)) };
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A walk of one coordinate that is seen with errors, filtered exactly. What frames up to t say of frame t − K is compared with the Gaussian of all
    /// states up to t, by messages from both ends, without a filter.
    #[test]
    fn a_pass_over_the_last_frames_is_the_fixed_lag_smoother_of_a_linear_gaussian_model() {
        let (q, r, lag) = (0.3, 0.8, 3);
        let seen = [0.4, -0.2, 1.1, 1.9, 1.4, 2.2, 2.6];
        let smoother = Smoother::random_walk(&[f64::sqrt(q)]);
        let (mut mean, mut variance) = (0.0, 1.7);
        let mut filtered = vec![];
        for (frame, y) in seen.into_iter().enumerate() {
            variance += if frame > 0 { q } else { 0.0 };
            let gain = variance / (variance + r);
            (mean, variance) = (mean + gain * (y - mean), variance * (1.0 - gain));
            let moments = Moments { mean: vec![mean], covariance: vec![variance] };
            let step = smoother.backward(&moments).unwrap();
            filtered.push((moments, step));
            let Some(wanted) = frame.checked_sub(lag) else { continue };
            let mut pass = BackwardPass::new(1, 5, Isa::baseline());
            let back = |(number, (moments, step)): (usize, &(Moments, BackwardStep))| {
                let filtered = FilteredFrame { moments, moves: &[], step, is_cut: false };
                pass.go_to(number as u64, filtered, &smoother).unwrap()
            };
            let numbers: Vec<_> = filtered.iter().enumerate().skip(wanted).rev().map(back).collect();
            let found = numbers.last().unwrap();
            // Messages to the frame from before and after, as precision and precision times mean.
            let message = |frames: &mut dyn Iterator<Item = usize>, first: [f64; 2]| {
                frames.fold(first, |[p, h], frame| {
                    let [p, h] = [p + 1.0 / r, h + seen[frame] / r];
                    let through = 1.0 / (1.0 + q * p);
                    [p * through, h * through]
                })
            };
            // The prior of the first frame has precision 1 / 1.7, and no step before it.
            let [p0, h0] = message(&mut (0..wanted), [1.0 / 1.7, 0.0]);
            let [p1, h1] = message(&mut (wanted + 1..=frame).rev(), [0.0; 2]);
            let precision = p0 + p1 + 1.0 / r;
            let expected = (h0 + h1 + seen[wanted] / r) / precision;
            assert!((found[0] - expected).abs() < 1e-12, "{} for {expected}", found[0]);
            let spread = found[1..].iter().map(|x| (x - expected).powi(2)).sum::<f64>() / TRAJECTORIES as f64;
            assert!((spread * precision - 1.0).abs() < 0.5, "{spread} for {}", 1.0 / precision);
        }
    }
}
