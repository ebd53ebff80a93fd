//! Results that know some frames of the future: fixed-lag smoothing, between the filter and the smoother.
//!
//! Once frame t is filtered, a backward pass over the moments of the last frames ([`BackwardPass`]) gives frame t − K what frames up to t say. With K = 0 that is the filter; with K as long as the recording it is the smoother of
//! [`super::smooth`], by the same numbers. Exact for linear-Gaussian models (Anderson & Moore 1979, ch. 7); elsewhere each frame's posterior is taken for a Gaussian.
//!
//! Steps back are factored once for each frame. The window holds K frames and half of that over which angles change, so neither memory nor the
//! cost of a frame grows.

use super::error::TrackError;
use super::pipeline::Pipeline;
use super::record::{Record, RecordShape};
use super::trajectories::TrajectoryDescriber;
use crate::Error;
use sinew_angles::fixed_lag::half_window;
use sinew_angles::trajectory_change::{change_between, window_around};
use sinew_body::KinematicTree;
use sinew_core::lanes::Isa;
use sinew_dynamics::backward_pass::{BackwardPass, FrameNumbers};
use sinew_dynamics::smoother::{BackwardStep, Smoother};
use sinew_results::estimate::FrameEstimate;
use sinew_results::problem::{self, Problem};
use std::collections::{BTreeMap, VecDeque};
use std::ops::Range;

/// A filtered frame with the step back to it.
struct Filtered {
    row: Vec<f64>,
    record: Record,
    step: BackwardStep,
}

/// The last frames of a filter.
pub struct LagWindow {
    lag: u64,
    half: u64,
    shape: RecordShape,
    fps: f64,
    /// Seed of random streams.
    pub(super) seed: u64,
    isa: Isa,
    smoother: Smoother,
    describer: TrajectoryDescriber,
    frames: VecDeque<Filtered>,
    /// Number of the oldest of them, counted from the first frame of the run.
    first: u64,
    /// The next frame to be given, counted likewise.
    next: u64,
}

impl LagWindow {
    /// Before the first frame; with numbers of cameras and keypoints.
    #[must_use]
    pub fn new(pipeline: &Pipeline, tree: &KinematicTree, lag: u64, [cameras, keypoints]: [usize; 2]) -> Self {
        let settings = pipeline.settings();
        let lasting_draws = pipeline.lasting_draws();
        Self {
            lag,
            half: half_window(settings.fps) as u64,
            shape: RecordShape { dim: tree.dof(), cameras, keypoints, lasting_draws },
            fps: settings.fps,
            seed: settings.seed,
            isa: settings.isa,
            smoother: Smoother::random_walk(pipeline.transition.sd()),
            describer: TrajectoryDescriber::new(pipeline, tree),
            frames: VecDeque::new(),
            first: 0,
            next: 0,
        }
    }

    /// Takes in a filtered frame, and gives the one that lies K frames before, if there is one.
    ///
    /// # Errors
    /// A covariance that cannot be factored.
    pub fn push(&mut self, estimate: &FrameEstimate) -> Result<Option<FrameEstimate>, Error> {
        let row = self.shape.row(estimate);
        self.frames.push_back(self.filtered(row)?);
        if self.end() <= self.next + self.lag {
            return Ok(None);
        }
        Ok(self.given(self.next..self.next + 1)?.pop())
    }

    /// The frames that are left at the end of the run.
    ///
    /// # Errors
    /// As [`LagWindow::push`].
    pub fn rest(&mut self) -> Result<Vec<FrameEstimate>, Error> {
        self.given(self.next..self.end())
    }

    fn filtered(&self, row: Vec<f64>) -> Result<Filtered, Error> {
        let record = self.shape.record(&row, self.fps);
        let step = self.smoother.backward(&record.moments).map_err(TrackError::Motion)?;
        Ok(Filtered { row, record, step })
    }

    /// The frame after the last one.
    fn end(&self) -> u64 {
        self.first + self.frames.len() as u64
    }

    fn at(&self, frame: u64) -> &Filtered {
        &self.frames[(frame - self.first) as usize]
    }

    /// Frames as one pass from the last frame has them, in order; what no later frame needs is forgotten.
    fn given(&mut self, wanted: Range<u64>) -> Result<Vec<FrameEstimate>, Error> {
        let there = self.first..self.end();
        let is_restarted = |frame| Ok::<_, Error>(self.at(frame).record.estimate.restarted);
        let windows = wanted.clone().map(|frame| window_around(frame, self.half, &there, is_restarted));
        let windows: Vec<[u64; 2]> = windows.collect::<Result<_, Error>>()?;
        let lowest = windows.iter().map(|[first, _]| *first).min().unwrap_or(there.end);
        let mut pass = BackwardPass::new(self.shape.dim, self.seed, self.isa);
        let mut passed: BTreeMap<u64, FrameNumbers> = BTreeMap::new();
        for frame in (lowest..there.end).rev() {
            let Filtered { record, step, .. } = self.at(frame);
            let numbers = pass.go_to(frame, record.filtered(step), &self.smoother).map_err(TrackError::Motion)?;
            if wanted.contains(&frame) || windows.as_flattened().contains(&frame) {
                passed.insert(frame, numbers);
            }
        }
        let RecordShape { dim, lasting_draws, .. } = self.shape;
        let mut given = Vec::with_capacity(windows.len());
        for (frame, [first, last]) in wanted.clone().zip(windows) {
            let seconds = (last - first) as f64 / self.fps;
            let between = || [&passed[&first], &passed[&last]];
            let change = (first < last).then(|| change_between(between(), dim, lasting_draws, seconds));
            let diagnostics = self.at(frame).record.estimate.clone();
            given.push(self.describer.describe(passed[&frame].clone(), change.as_ref(), diagnostics));
        }
        self.next = wanted.end.max(self.next);
        while self.first + self.half < self.next && self.frames.len() > 1 {
            self.frames.pop_front();
            self.first += 1;
        }
        Ok(given)
    }

    /// What [`LagWindow::restore`] takes.
    #[must_use]
    pub fn save(&self) -> Vec<f64> {
        let angles = self.describer.angles_before();
        let mut saved = vec![self.first as f64, self.next as f64, angles.len() as f64];
        saved.extend(angles);
        self.frames.iter().for_each(|frame| saved.extend(&frame.row));
        saved
    }

    /// Continues where another window of the same run stood.
    ///
    /// # Errors
    /// Numbers of another run.
    pub fn restore(&mut self, saved: &[f64]) -> Result<(), Problem> {
        let other = || problem::state("window of the last frames", saved.len(), "its numbers");
        let Some((&[first, next, angles], rest)) = saved.split_first_chunk() else { return Err(other()) };
        let Some((angles, rows)) = rest.split_at_checked(angles as usize) else { return Err(other()) };
        let (count, most) = (self.shape.numbers(), (self.lag + self.half + 1) as usize);
        (self.first, self.next) = (first as u64, next as u64);
        let fits = rows.len().is_multiple_of(count) && rows.len() / count <= most && self.first <= self.next;
        if !fits || !self.describer.continue_behind(angles) {
            return Err(other());
        }
        let frames = rows.chunks_exact(count).map(|row| self.filtered(row.to_vec()));
        self.frames = frames.collect::<Result<_, _>>().map_err(|_| other())?;
        if self.next <= self.end() { Ok(()) } else { Err(other()) }
    }
}
