//! How a command ended, if not with an error.

use super::report::Report;
use sinew_words::exit_codes::{DOUBTFUL, FAILED, INTERRUPTED};

/// The end of a command.
pub(crate) enum Ended {
    /// Done.
    Done,
    /// Finished and written, but a diagnostic failed.
    Doubtful,
    /// Done as far as possible: some of many failed.
    Failed,
    /// Interrupted; what was done is written.
    Interrupted,
}

impl Ended {
    pub(crate) const fn code(&self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Failed => FAILED,
            Self::Doubtful => DOUBTFUL,
            Self::Interrupted => INTERRUPTED,
        }
    }
}

/// The end of a run whose diagnostics may have failed, which are said.
pub(crate) fn doubts<T: AsRef<str>>(failed: &[T], report: &Report) -> Ended {
    failed.iter().for_each(|failed| report.failed(failed.as_ref()));
    if failed.is_empty() { Ended::Done } else { Ended::Doubtful }
}
