//! Why a run that was stopped cannot be resumed.

use std::path::PathBuf;

/// Name of the checkpoint in a result folder.
pub const NAME: &str = "checkpoint.bin";

/// Version of its layout.
pub const FORMAT: u32 = 15;

/// Why a run cannot be resumed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// No run was stopped here.
    #[error("holds no checkpoint: there is no run to resume")]
    Missing,
    /// A run was stopped here too early.
    #[error("holds a run that was stopped in its set-up, before its first frame: there is nothing to resume")]
    BeforeFirst,
    /// The summary of results is not one of this program.
    #[error("holds a `summary.json` that does not say of what it is")]
    Summary,
    /// The file begins otherwise.
    #[error("holds a `{NAME}` that is not a checkpoint of sinew")]
    Foreign,
    /// The file ends too early or too late.
    #[error("holds a `{NAME}` of {found} bytes; expected {expected}: it was cut or is damaged")]
    Length {
        /// Bytes found.
        found: u64,
        /// Bytes announced.
        expected: u64,
    },
    /// The checksum does not fit.
    #[error("holds a damaged `{NAME}`: its checksum is {found:08x}, expected {expected:08x}")]
    Checksum {
        /// That of the bytes.
        found: u32,
        /// That in the file.
        expected: u32,
    },
    /// Another layout of the file.
    #[error("holds a checkpoint of format {found}; this program reads format {FORMAT}")]
    Format {
        /// Format of the file.
        found: u32,
    },
    /// Another version of the program.
    #[error("holds a run of sinew {found}; this is {}", env!("CARGO_PKG_VERSION"))]
    Program {
        /// Version in the file.
        found: String,
    },
    /// The body is not what the format says, or does not fit the run.
    #[error("holds a checkpoint whose {what} does not fit: found {found}, expected {expected}")]
    State {
        /// What.
        what: String,
        /// Found.
        found: String,
        /// Expected.
        expected: String,
    },
    /// One person where several are to be tracked, or the other way round.
    #[error("holds a run of {found}; this is one of {expected}")]
    Whom {
        /// Who was tracked there.
        found: &'static str,
        /// Whom to track.
        expected: &'static str,
    },
    /// Other settings.
    #[error("holds a run with other settings: {}", .0.join("; "))]
    Settings(Vec<String>),
    /// Other data.
    #[error("holds a run on other data: {}", .0.join("; "))]
    Inputs(Vec<String>),
    /// A result file is not as it was left.
    #[error("holds a run whose file `{}` was changed or cut after it was stopped", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
}

impl Problem {
    /// Whether there is no frame yet from which a run could be resumed.
    #[must_use]
    pub const fn is_before_first(&self) -> bool {
        matches!(self, Self::Missing | Self::BeforeFirst)
    }
}

/// That a part of a saved state is not what this run needs.
pub fn state(what: &str, found: impl ToString, expected: impl ToString) -> Problem {
    Problem::State { what: what.into(), found: found.to_string(), expected: expected.to_string() }
}

/// Refuses a list of the wrong length in a checkpoint.
pub fn check_length(found: usize, expected: usize) -> Result<(), Problem> {
    if found == expected { Ok(()) } else { Err(state("state", format!("{found} numbers"), expected)) }
}
