//! Motion files that a model is learned from, and others that are held out.
//!
//! A body follows them, a hash distinguishes them, and no output replaces one.

use super::sequences::{Acclaim, Sequences, sequences};
use crate::Error;
use crate::follow::NamedBody;
use sinew_input::files::{FNV_START, fnv};
use sinew_results::Occupied;
use std::path::{Path, PathBuf};

/// Which files, and whose states they are.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionFiles {
    /// Motion files to learn from.
    pub motion: Vec<PathBuf>,
    /// Motion files to try the model on.
    pub held_out: Vec<PathBuf>,
    /// Skeleton of all AMC files; each has its own beside it if `None`.
    pub skeleton: Option<PathBuf>,
    /// Frames per second of AMC files, which state none; 120 if `None`.
    pub amc_hz: Option<f64>,
    /// Body whose states move.
    pub body: NamedBody,
    /// Frames per second of the model.
    pub fps: f64,
}

/// Part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LearnPhase {
    /// The body is fitted to files.
    Follow,
    /// The model is learned.
    Learn,
}

/// Takes a phase, the files or steps that are done, and all of them.
pub type PhaseReport<'a> = dyn FnMut(LearnPhase, u64, u64) + Send + 'a;

/// The body along some motion.
pub(super) struct Following {
    /// States of the files to learn from.
    pub(super) training: Sequences,
    /// States of those that are held out.
    pub(super) held_out: Sequences,
    /// What was odd in either.
    pub(super) warnings: Vec<String>,
}

impl MotionFiles {
    /// Makes the body follow all files.
    pub(super) fn follow(&self, report: &mut PhaseReport<'_>) -> Result<Following, Error> {
        let total = (self.motion.len() + self.held_out.len()) as u64;
        let mut some = |files: &[PathBuf], before: usize| {
            let mut done = |done: usize| report(LearnPhase::Follow, (before + done) as u64, total);
            let acclaim = Acclaim { skeleton: self.skeleton.as_deref(), hz: self.amc_hz };
            sequences(self.body, files, acclaim, self.fps, &mut done)
        };
        let training = some(&self.motion, 0)?;
        let held_out = some(&self.held_out, self.motion.len())?;
        let warnings = training.warnings.iter().chain(&held_out.warnings).cloned().collect();
        Ok(Following { training, held_out, warnings })
    }

    /// Refuses an output that exists (without `force`), is a folder or one of the files.
    pub(super) fn refuse_output(&self, out: &Path, force: bool) -> Result<(), Error> {
        let Ok(place) = out.canonicalize() else { return Ok(()) };
        let inputs = self.motion.iter().chain(&self.held_out).chain(&self.skeleton);
        if let Some(input) = inputs.into_iter().find(|input| input.canonicalize().is_ok_and(|input| input == place)) {
            return Err(sinew_results::Error::OutputIsInput { path: out.to_owned(), input: input.clone() }.into());
        }
        if place.is_dir() {
            return Err(sinew_results::Error::io("write", out)(std::io::ErrorKind::IsADirectory.into()).into());
        }
        if !force {
            return Err(sinew_results::Error::OutputExists { path: out.to_owned(), found: Occupied::File }.into());
        }
        Ok(())
    }

    /// Hash of all that decides what is learned: version, body, rate, what `settings` says, and the sequences.
    pub(super) fn fingerprint<'a>(&self, settings: &str, sequences: impl Iterator<Item = &'a [f64]> + Clone) -> u64 {
        let head = format!("{} {} {} {settings}", env!("CARGO_PKG_VERSION"), self.body.name(), self.fps);
        let lengths = sequences.clone().map(|sequence| sequence.len() as u64);
        let numbers = sequences.flatten().map(|x| x.to_bits());
        lengths.chain(numbers).fold(fnv(FNV_START, head.as_bytes()), |hash, bits| fnv(hash, &bits.to_le_bytes()))
    }
}
