//! What a run is to do, and what it came to.

use super::listener::Listener;
use crate::config::Resolved;
use crate::track::job::Outcome;
use sinew_results::people::PeopleSummary;
use sinew_results::{Disk, Storage};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a run is to do besides tracking.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Continue a run that was stopped.
    pub resume: bool,
    /// Whether a page is written into the results afterwards: what is in its way is refused before anything is computed.
    pub page: bool,
    /// Write the calibration as the set-up refined it.
    pub write_calibration: Option<PathBuf>,
    /// Where files are kept; on the disk, each waited for, if `None`.
    pub storage: Option<Arc<dyn Storage>>,
    /// File of settings that was named, which the run must not replace.
    pub settings_file: Option<PathBuf>,
}

impl Request {
    /// Where files are kept.
    pub(crate) fn storage(&self) -> Arc<dyn Storage> {
        self.storage.clone().unwrap_or_else(|| Arc::new(Disk))
    }
}

/// What a run came to.
#[derive(Debug)]
pub enum CameTo {
    /// One person was tracked.
    One(Box<Outcome>),
    /// Results were complete before; their summary.
    Complete(serde_json::Value),
    /// Several people were tracked.
    Several(PeopleSummary),
}

/// What the run of one person came to.
#[derive(Debug)]
pub(crate) enum OneCameTo {
    /// They were tracked.
    Tracked(Box<Outcome>),
    /// Results were complete before; their summary.
    Complete(serde_json::Value),
}

impl From<OneCameTo> for CameTo {
    fn from(came_to: OneCameTo) -> Self {
        match came_to {
            OneCameTo::Tracked(outcome) => Self::One(outcome),
            OneCameTo::Complete(summary) => Self::Complete(summary),
        }
    }
}

/// What stays the same over a run, from person to person.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) resolved: &'a Resolved,
    pub(crate) request: &'a Request,
    pub(crate) calibration: &'a Path,
    pub(crate) read_from: &'a [PathBuf],
    pub(crate) listener: &'a dyn Listener,
}
