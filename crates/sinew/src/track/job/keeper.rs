//! The files of a run in progress and the checkpoint behind them.

use super::inputs::Hashes;
use super::run_info::texts;
use crate::Error;
use crate::config::TrackConfig;
use crate::input::upright::FramesRead;
use crate::results::estimate::RunInfo;
use crate::results::{Claim, ResultFolder};
use crate::track::checkpoint::{self, Checkpoint};
use crate::track::pipeline::Pipeline;
use crate::track::smooth::Spool;
use std::time::{Duration, Instant};

/// The files of a run and its checkpoint.
pub(super) struct Keeper {
    pub(super) results: ResultFolder,
    pub(super) spool: Option<Spool>,
    pub(super) checkpoint: Checkpoint,
    every: Duration,
    kept: Instant,
    cost: Duration,
}

/// Checkpoints take at most this share of the time, however large they are, unless they are wanted after every frame.
const SHARE: u32 = 20;

impl Keeper {
    /// The files of a run, new or as a stopped one left them, and a spool for the backward pass.
    pub(super) fn open(
        claim: Claim,
        info: RunInfo,
        checkpoint: Checkpoint,
        config: &TrackConfig,
        lasting_draws: usize,
    ) -> Result<Self, Error> {
        let spool = match config.smooth {
            true => {
                let sizes = [info.body.dof(), info.cameras.len(), info.keypoints.len(), lasting_draws];
                let before = checkpoint.spool.map(|position| (checkpoint.done, position));
                Some(Spool::open(&claim, sizes, before)?)
            }
            false => None,
        };
        let results = ResultFolder::open(claim, info, texts(&checkpoint)?, checkpoint.written.as_ref())?;
        let every = Duration::try_from_secs_f64(config.checkpoint_every).unwrap_or(Duration::MAX);
        Ok(Self { results, spool, checkpoint, every, kept: Instant::now(), cost: Duration::ZERO })
    }

    /// Whether it is time for a checkpoint.
    pub(super) fn is_due(&self) -> bool {
        let least = if self.every.is_zero() { self.every } else { self.every.max(SHARE * self.cost) };
        self.kept.elapsed() >= least
    }

    /// Writes the checkpoint, behind the files that it speaks of; `read` is what the set-up read.
    pub(super) fn keep(&mut self, pipeline: &Pipeline, read: &FramesRead, inputs: Hashes) -> Result<(), Error> {
        let clock = Instant::now();
        let checkpoint = &mut self.checkpoint;
        match &mut self.spool {
            Some(spool) => checkpoint.spool = Some(spool.keep()?),
            None => checkpoint.written = Some(self.results.keep()?),
        }
        checkpoint.pipeline = Some(pipeline.save());
        checkpoint.read = read.clone();
        checkpoint.inputs = inputs;
        checkpoint::write(self.results.claim(), checkpoint)?;
        self.kept = Instant::now();
        self.cost = clock.elapsed();
        Ok(())
    }
}
