//! What is written of the states of trajectories in a frame.

use super::lasting::Lasting;
use super::marginals::{Described, Marginals};
use super::pipeline::Pipeline;
use sinew_angles::AngleMarginals;
use sinew_angles::marginals::AngleChange;
use sinew_body::KinematicTree;
use sinew_dynamics::backward_pass::{FrameNumbers, TRAJECTORIES, state_blocks};
use sinew_results::estimate::{Draws, FrameEstimate};
use sinew_tracking::moved::Moved;
use sinew_tracking::posterior::Posterior;

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
        let states = state_blocks(numbers, d);
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
