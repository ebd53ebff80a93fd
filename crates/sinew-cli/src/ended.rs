//! How a command ended, if not with an error.

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
            Self::Failed => 1,
            Self::Doubtful => 4,
            Self::Interrupted => 75,
        }
    }
}
