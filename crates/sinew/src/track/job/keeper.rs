//! The files of a run in progress and the checkpoint behind them.

use super::run_info::texts;
use crate::Error;
use crate::config::TrackConfig;
use crate::input::source::InputHashes;
use crate::input::upright::FramesRead;
use crate::track::checkpoint::{self, Checkpoint};
use crate::track::fixed_lag::LagWindow;
use crate::track::pipeline::Pipeline;
use crate::track::smooth::Spool;
use sinew_results::estimate::{FrameEstimate, RunInfo};
use sinew_results::{Claim, ResultFolder};
use std::time::{Duration, Instant};

/// The files of a run and its checkpoint.
pub(super) struct Keeper {
    pub(super) results: ResultFolder,
    pub(super) spool: Option<Spool>,
    window: Option<LagWindow>,
    pub(super) checkpoint: Checkpoint,
    every: Duration,
    kept: Instant,
    cost: Duration,
}

/// Checkpoints take at most this share of the time, however large they are, unless they are wanted after every frame.
const SHARE: u32 = 20;

impl Keeper {
    /// The files of a run, new or as a stopped one left them, and a spool for the backward pass or the window of a fixed lag.
    pub(super) fn open(
        claim: Claim,
        info: RunInfo,
        checkpoint: Checkpoint,
        config: &TrackConfig,
        pipeline: &Pipeline,
    ) -> Result<Self, Error> {
        let seen = [info.cameras.len(), info.keypoints.len()];
        let window = (config.lag_frames > 0).then(|| LagWindow::new(pipeline, &info.body, config.lag_frames, seen));
        let window = window.map(|mut window| {
            let saved = checkpoint.window.as_deref().unwrap_or_default();
            let saved: Vec<f64> = saved.iter().map(|bits| f64::from_bits(*bits)).collect();
            let restored = if saved.is_empty() { Ok(()) } else { window.restore(&saved) };
            restored.map_err(|problem| sinew_results::Error::checkpoint(claim.folder(), problem)).map(|()| window)
        });
        let window = window.transpose()?;
        let spool = match config.smooth {
            true => {
                let [cameras, keypoints] = seen;
                let sizes = [info.body.dof(), cameras, keypoints, pipeline.lasting_draws()];
                let before = checkpoint.spool.map(|position| (checkpoint.done, position));
                Some(Spool::open(&claim, sizes, before)?)
            }
            false => None,
        };
        let results = ResultFolder::open(claim, info, texts(&checkpoint)?, checkpoint.written.as_ref())?;
        let every = match results.claim().storage().is_temporary() {
            true => Duration::MAX,
            false => Duration::try_from_secs_f64(config.checkpoint_every).unwrap_or(Duration::MAX),
        };
        let (kept, cost) = (Instant::now(), Duration::ZERO);
        Ok(Self { results, spool, window, checkpoint, every, kept, cost })
    }

    /// Whether frames are given later than they are tracked.
    pub(super) const fn is_late(&self) -> bool {
        self.window.is_some()
    }

    /// The seed of random streams from the next frame on.
    pub(super) fn seed(&mut self, seed: u64) {
        if let Some(window) = &mut self.window {
            window.seed = seed;
        }
    }

    /// Takes in a frame that was tracked, and writes what is known by now; `known` hears of it first.
    pub(super) fn take(&mut self, estimate: FrameEstimate, mut known: impl FnMut(&FrameEstimate)) -> Result<(), Error> {
        self.checkpoint.done += 1;
        if let Some(spool) = &mut self.spool {
            return spool.append(&estimate);
        }
        let given = match &mut self.window {
            Some(window) => window.push(&estimate)?,
            None => Some(estimate),
        };
        given.map_or(Ok(()), |estimate| {
            known(&estimate);
            Ok(self.results.append(&estimate)?)
        })
    }

    /// Writes the frames for which a fixed lag still waits.
    pub(super) fn take_rest(&mut self, mut known: impl FnMut(&FrameEstimate)) -> Result<(), Error> {
        let Some(window) = &mut self.window else { return Ok(()) };
        for estimate in window.rest()? {
            known(&estimate);
            self.results.append(&estimate)?;
        }
        Ok(())
    }

    /// Whether it is time for a checkpoint.
    pub(super) fn is_due(&self) -> bool {
        let least = if self.every.is_zero() { self.every } else { self.every.max(SHARE * self.cost) };
        self.kept.elapsed() >= least
    }

    /// Writes the checkpoint, behind the files that it speaks of, where a run is ever resumed; `read` is what the set-up read.
    pub(super) fn keep(&mut self, pipeline: &Pipeline, read: &FramesRead, inputs: InputHashes) -> Result<(), Error> {
        if self.results.claim().storage().is_temporary() {
            return Ok(());
        }
        let clock = Instant::now();
        let checkpoint = &mut self.checkpoint;
        match &mut self.spool {
            Some(spool) => checkpoint.spool = Some(spool.keep()?),
            None => checkpoint.written = Some(self.results.keep()?),
        }
        let saved = self.window.as_ref().map(LagWindow::save);
        checkpoint.window = saved.map(|saved| saved.into_iter().map(f64::to_bits).collect());
        checkpoint.pipeline = Some(pipeline.save());
        checkpoint.read = read.clone();
        checkpoint.inputs = inputs;
        checkpoint::write(self.results.claim(), checkpoint)?;
        self.kept = Instant::now();
        self.cost = clock.elapsed();
        Ok(())
    }
}
