//! Trajectories through filtered frames, drawn backwards, and what is written of their states in a frame.
//!
//! Draw *i* of every frame that one pass goes through belongs to trajectory *i*. The noise of a frame depends on seed and frame alone, so passes that begin in different frames
//! share it. Where tracking restarted the motion prior says nothing of the step, so the pass is cut there: the frame before counts as a last one.

use super::error::TrackError;
use super::lasting::Lasting;
use super::marginals::{Described, Marginals};
use super::pipeline::Pipeline;
use super::record::Record;
use crate::results::estimate::{Draws, FrameEstimate};
use sinew_angles::AngleMarginals;
use sinew_angles::marginals::{AngleChange, LaterFrame};
use sinew_body::KinematicTree;
use sinew_core::lanes::{Block, Isa, LANES, get_lane, set_lane};
use sinew_core::random::Stage;
use sinew_dynamics::smoother::{BackwardStep, Smoother};
use sinew_tracking::moved::{Moved, Rows};
use sinew_tracking::posterior::Posterior;
use std::ops::Range;

/// Trajectories drawn.
pub const TRAJECTORIES: usize = 128;

/// The states of trajectories in a frame: the smoothed mean, the states one after the other, and the moves of the draws of what is constant.
pub(super) type FrameNumbers = Vec<f64>;

/// Numbers of [`FrameNumbers`].
pub(super) const fn numbers_of_frame(dim: usize, lasting_draws: usize) -> usize {
    (1 + TRAJECTORIES + lasting_draws) * dim
}

/// A pass backwards through filtered frames.
pub(super) struct BackwardPass {
    states: Vec<Block>,
    /// Smoothed mean of the frame after, and moves of its draws; none where the pass begins, or begins again.
    next: Option<(Vec<f64>, Vec<f64>)>,
    seed: u64,
    isa: Isa,
}

impl BackwardPass {
    /// Before the last frame.
    pub(super) fn new(dim: usize, seed: u64, isa: Isa) -> Self {
        Self { states: vec![Block::ZERO; TRAJECTORIES / LANES * dim], next: None, seed, isa }
    }

    /// Goes back to a frame, counted from the first of the run; `step` is the step back to it.
    ///
    /// # Errors
    /// A covariance that cannot be factored.
    pub(super) fn go_to(
        &mut self,
        frame: u64,
        record: &Record,
        smoother: &Smoother,
        step: &BackwardStep,
    ) -> Result<FrameNumbers, TrackError> {
        let Self { states, next, seed, isa } = self;
        let rng = &mut Stage::new(*seed, "smooth").at_frame(frame as u32).whole();
        let (mean, moves) = match next {
            None => {
                smoother.sample_last(&record.moments, states, *isa, rng).map_err(TrackError::Motion)?;
                (record.moments.mean.clone(), record.moves.clone())
            }
            Some((mean, moves)) => {
                let moves = match moves.is_empty() {
                    true => vec![],
                    false => step.changes(&record.moves, moves).map_err(TrackError::Motion)?,
                };
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
        *next = if record.estimate.restarted { None } else { Some((mean, moves)) };
        Ok(numbers)
    }
}

/// The first and the last frame of a window of some frames on both sides of a frame, cut where tracking restarted and at the ends of `frames`.
///
/// # Errors
/// Errors of `is_restarted`.
pub(super) fn window_around<E>(
    frame: u64,
    half: u64,
    frames: &Range<u64>,
    mut is_restarted: impl FnMut(u64) -> Result<bool, E>,
) -> Result<[u64; 2], E> {
    let [mut first, mut last] = [frame; 2];
    while first > frames.start && frame - first < half && !is_restarted(first)? {
        first -= 1;
    }
    while last + 1 < frames.end && last - frame < half && !is_restarted(last + 1)? {
        last += 1;
    }
    Ok([first, last])
}

/// How angles change between two frames of a pass that are `seconds` apart.
pub(super) fn change_between(numbers: [&FrameNumbers; 2], dim: usize, lasting_draws: usize, seconds: f64) -> AngleChange {
    let [earlier, later] = numbers.map(|numbers| {
        let (numbers, moves) = numbers.split_at((1 + TRAJECTORIES) * dim);
        let mut states = numbers[dim..].to_vec();
        if lasting_draws > 0 {
            Rows::new(moves, lasting_draws).add_columns(&mut states);
        }
        blocks(&states, dim)
    });
    AngleChange { earlier, later: LaterFrame::States(later), seconds }
}

/// States one after the other as blocks.
fn blocks(numbers: &[f64], dim: usize) -> Vec<Block> {
    let mut states = vec![Block::ZERO; TRAJECTORIES / LANES * dim];
    for (i, state) in numbers.chunks_exact(dim).enumerate() {
        set_lane(&mut states[i / LANES * dim..][..dim], i % LANES, state);
    }
    states
}

/// Makes estimates of the states of trajectories, frame after frame.
pub(super) struct TrajectoryDescriber {
    marginals: Marginals,
    angles: AngleMarginals,
    lasting: Option<Lasting>,
    dim: usize,
    draws: usize,
    weights: Vec<f64>,
}

impl TrajectoryDescriber {
    /// Before the first frame.
    pub(super) fn new(pipeline: &Pipeline, tree: &KinematicTree) -> Self {
        let settings = pipeline.settings();
        Self {
            marginals: Marginals::new(tree, pipeline.detected_plan(), settings.isa, pipeline.size().cloned()),
            angles: AngleMarginals::new(pipeline.angles().clone(), pipeline.zero().cloned()),
            lasting: pipeline.lasting().filter(|lasting| lasting.draws() > 0).cloned(),
            dim: tree.dof(),
            draws: settings.draws.min(TRAJECTORIES),
            weights: vec![1.0 / TRAJECTORIES as f64; TRAJECTORIES],
        }
    }

    /// Angles of the mean pose in the frame before.
    pub(super) fn angles_before(&self) -> &[f64] {
        self.angles.before()
    }

    /// Continues behind such a frame; false for another number of angles.
    pub(super) fn continue_behind(&mut self, angles: &[f64]) -> bool {
        self.angles.continue_behind(angles)
    }

    /// A frame with its diagnostics, as the trajectories have it.
    pub(super) fn describe(
        &mut self,
        mut numbers: FrameNumbers,
        change: Option<&AngleChange>,
        diagnostics: FrameEstimate,
    ) -> FrameEstimate {
        let d = self.dim;
        let moves = numbers.split_off((1 + TRAJECTORIES) * d);
        let (mean_state, numbers) = numbers.split_at_mut(d);
        let moved: Option<Moved> = self.lasting.as_ref().map(|lasting| lasting.moved(mean_state, &moves));
        if let Some(moved) = &moved {
            moved.apply(numbers);
            mean_state.iter_mut().zip(moved.mean()).for_each(|(x, by)| *x += by);
        }
        let states = blocks(numbers, d);
        let (weights, effective) = (&self.weights, TRAJECTORIES as f64);
        let posterior = Posterior { dim: d, states: &states, weights, effective, chain_stats: &[] };
        let Described { points, keypoints, state } = self.marginals.of(&posterior, moved.as_ref());
        let angles = self.angles.of(mean_state, &posterior, change);
        let mut kept = numbers[..self.draws * d].to_vec();
        let size = self.marginals.size_draws(&mut kept, d);
        let written = self.lasting.as_ref().zip(moved.as_ref()).map(|(lasting, moved)| lasting.written(moved, &kept));
        let [shape, detected] = written.unwrap_or_default();
        let draws = Draws { states: kept, shape, detected, size, ..Draws::default() };
        FrameEstimate { mean_state: mean_state.to_vec(), points, keypoints, state, angles, draws, ..diagnostics }
    }
}
