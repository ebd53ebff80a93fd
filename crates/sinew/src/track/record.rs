//! A filtered frame as a row of numbers, bit for bit: what a backward pass needs of it.
//!
//! Diagnostics, what was seen, filtered moments, moves of draws; a row has the same length in all frames of a run.

use sinew_core::transition::Moments;
use sinew_dynamics::backward_pass::FilteredFrame;
use sinew_dynamics::smoother::BackwardStep;
use sinew_results::estimate::{FrameEstimate, diagnostics};

/// What the length of a row depends on, the same in all frames of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordShape {
    /// Degrees of freedom.
    pub(super) dim: usize,
    /// Cameras.
    pub(super) cameras: usize,
    /// Keypoints that are points of the body.
    pub(super) keypoints: usize,
    /// Draws of what is constant.
    pub(super) lasting_draws: usize,
}

/// A frame that was read back from a row.
pub(super) struct Record {
    /// Its diagnostics and what was seen.
    pub(super) estimate: FrameEstimate,
    /// [`FrameEstimate::filtered`].
    pub(super) moments: Moments,
    /// [`FrameEstimate::moves`].
    pub(super) moves: Vec<f64>,
}

impl Record {
    /// The frame as a backward pass takes it; `step` leads from the next frame back to this one.
    pub(super) fn filtered<'a>(&'a self, step: &'a BackwardStep) -> FilteredFrame<'a> {
        FilteredFrame { moments: &self.moments, moves: &self.moves, step, is_cut: self.estimate.restarted }
    }
}

impl RecordShape {
    /// Numbers before the moments.
    pub(super) fn header(self) -> usize {
        diagnostics::count(self.cameras) + 3 * self.cameras * self.keypoints
    }

    /// Numbers of a row: the header, then mean (d), covariance (d × d) and moves (d × draws).
    pub(super) fn numbers(self) -> usize {
        self.header() + self.dim * (self.dim + 1 + self.lasting_draws)
    }

    /// The row of a frame.
    pub(super) fn row(self, estimate: &FrameEstimate) -> Vec<f64> {
        let mut row = diagnostics::numbers(estimate, self.cameras);
        row.extend(estimate.seen.as_flattened());
        row.resize(self.header(), f64::NAN);
        row.extend(estimate.filtered.mean.iter().chain(&estimate.filtered.covariance).chain(&estimate.moves));
        row.resize(self.numbers(), 0.0);
        row
    }

    /// Diagnostics and what was seen, which stand at the beginning of a row.
    pub(super) fn estimate(self, row: &[f64], fps: f64) -> FrameEstimate {
        let (diagnostics, seen) = row[..self.header()].split_at(diagnostics::count(self.cameras));
        FrameEstimate {
            seen: seen.as_chunks().0.to_vec(),
            ..diagnostics::estimate(diagnostics, fps).unwrap_or_default()
        }
    }

    /// The frame of a row.
    pub(super) fn record(self, row: &[f64], fps: f64) -> Record {
        let (mean, rest) = row[self.header()..].split_at(self.dim);
        let (covariance, moves) = rest.split_at(self.dim * self.dim);
        let moments = Moments { mean: mean.to_vec(), covariance: covariance.to_vec() };
        Record { estimate: self.estimate(row, fps), moments, moves: moves.to_vec() }
    }
}
