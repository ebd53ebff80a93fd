//! What can go wrong with a study of many trials.

use sinew_input::{FileError, Problems};
use std::path::PathBuf;

/// Everything that ends a step of a study early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What ends a run early.
    #[error(transparent)]
    Run(#[from] sinew::Error),
    /// A folder without trials.
    #[error("{} holds no trial: no `sinew.toml` that names keypoints or silhouettes, and no folder `pose` with keypoints", .0.display())]
    NoTrials(PathBuf),
    /// A folder that is no study.
    #[error("{} is not a study: it has no `plan.json` and `tasks.jsonl`", .0.display())]
    NotAStudy(PathBuf),
    /// A file of a study that was changed.
    #[error("{}, line {line}: {problem}", path.display())]
    StudyFile {
        /// The file.
        path: PathBuf,
        /// Line in it.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A shard that another process runs.
    #[error("shard {shard} of {} is being run by another process", study.display())]
    ShardInUse {
        /// Which.
        shard: String,
        /// Folder of the study.
        study: PathBuf,
    },
    /// A trial without packed results.
    #[error("{} has no packed results of `{trial}`", study.display())]
    NotPacked {
        /// Folder of the study.
        study: PathBuf,
        /// Name given.
        trial: String,
    },
    /// Trials that cannot share a set-up.
    #[error("the trials of `{pool}` have different cameras or keypoints and cannot share a set-up")]
    UnlikeTrials {
        /// Name of the pool.
        pool: String,
    },
}

sinew_input::errors_from_below!(
    Error::Run: sinew_results::Error, sinew_setup::Error, sinew_input::Error, sinew_formats::Error, FileError, Problems
);

/// The code with which a program would end for an error; the ledger keeps it.
pub type ExitCode = fn(&Error) -> u8;
