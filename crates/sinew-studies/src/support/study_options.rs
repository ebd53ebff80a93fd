//! Options that studies share: how many cells run at a time, where they are kept, and where recordings are.

use crate::support::outcome::Outcome;
use std::path::{Path, PathBuf};

/// What every study takes.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct StudyOptions {
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    /// Folder for models, cells, tables and figures [default: under target, by the name of the study]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    pub(crate) data: Option<PathBuf>,
}

impl StudyOptions {
    /// What stands where no command line says otherwise.
    pub(crate) fn usual() -> Self {
        Self { data: std::env::var_os("SINEW_DATA").map(PathBuf::from), ..Self::default() }
    }

    /// Cells that run at a time.
    pub(crate) fn threads(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()))
    }

    /// The folder of the study, made; `name` is its place under `target`.
    pub(crate) fn folder(&self, root: &Path, name: &str) -> Outcome<PathBuf> {
        let folder = self.out.clone().unwrap_or_else(|| root.join("target").join(name));
        std::fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// The folder of the recordings, whether it is there or not.
    pub(crate) fn data(&self, root: &Path) -> PathBuf {
        self.data.clone().unwrap_or_else(|| root.join("../shared/data"))
    }

    /// The folder of recordings that a study learns from.
    ///
    /// # Errors
    /// A folder without them.
    pub(crate) fn recordings(&self, root: &Path) -> Outcome<PathBuf> {
        let data = self.data(root);
        match data.join("cmu_amc").is_dir() {
            true => Ok(data),
            false => Err(format!("no recordings in {}: the study learns from them", data.display()).into()),
        }
    }
}
