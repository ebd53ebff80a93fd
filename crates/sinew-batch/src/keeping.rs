//! What trials come to goes to the disk: results first, then the lines of the ledger.
//!
//! One thread does it while the next trials are computed. What ended since it last waited for the disk is waited for together: a wait costs as much for ten trials as for one.

use super::ledger::{EndedTask, Ledger, TaskEnd};
use super::packed::Archive;
use super::scratch::Scratch;
use crate::{Error, ExitCode};
use sinew_results::sync_below;
use std::path::Path;
use std::sync::mpsc::Receiver;

/// A trial that ended, and is not on the disk yet.
pub(super) struct Ended {
    /// Its place among those that were missing.
    pub(super) place: usize,
    /// Its line.
    pub(super) line: EndedTask,
    /// Its results, where they are to be packed.
    pub(super) scratch: Option<Scratch>,
}

/// Where trials are kept.
pub(super) struct Keeping<'a> {
    pub(super) study: &'a Path,
    pub(super) archive: Option<Archive>,
    pub(super) ledger: Ledger,
    pub(super) exit_code: ExitCode,
}

impl Keeping<'_> {
    /// Keeps trials until no more come; `kept` hears of each that is on the disk.
    ///
    /// # Errors
    /// A ledger that cannot be written. Results that cannot be written are a failure of their trials.
    pub(super) fn keep(&mut self, ended: Receiver<Ended>, mut kept: impl FnMut(&Ended)) -> Result<(), Error> {
        while let Ok(first) = ended.recv() {
            let mut group: Vec<Ended> = std::iter::once(first).chain(ended.try_iter()).collect();
            group.iter_mut().for_each(|ended| self.pack(ended));
            let synced = match &self.archive {
                Some(archive) => archive.sync(),
                None => sync_below(self.study).map_err(sinew::Error::io("write", self.study)).map_err(Error::from),
            };
            if let Err(error) = synced {
                group.iter_mut().for_each(|ended| ended.line.fail(&error, self.exit_code));
            }
            self.ledger.add(group.iter().map(|ended| &ended.line))?;
            group.iter().for_each(&mut kept);
        }
        Ok(())
    }

    /// Puts results into the archive, if they are to be there.
    fn pack(&mut self, ended: &mut Ended) {
        let (Some(archive), Some(scratch)) = (&mut self.archive, ended.scratch.take()) else { return };
        match archive.append(&ended.line.trial, &scratch) {
            Ok(packed) => ended.line.packed = Some(packed),
            Err(error) => ended.line.fail(&error, self.exit_code),
        }
    }
}

impl EndedTask {
    /// What could not be kept failed, if it had not failed before.
    fn fail(&mut self, error: &Error, exit_code: ExitCode) {
        if self.ended != TaskEnd::Failed {
            (self.ended, self.code, self.packed) = (TaskEnd::Failed, exit_code(error), None);
            self.why = sinew::with_causes(error);
        }
    }
}
