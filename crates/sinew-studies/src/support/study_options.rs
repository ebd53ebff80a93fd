//! Options that studies share: how many cells run at a time, where they are kept, where recordings and the program are.

use crate::support::outcome::Outcome;
use crate::support::program::{Program, built};
use std::path::{Path, PathBuf};

/// What is missing, where it comes from, and what runs without it.
pub(crate) fn no_recordings(data: &Path) -> String {
    format!(
        "no folder cmu_amc in {}: it holds trials of the CMU Graphics Lab Motion Capture Database (mocap.cs.cmu.edu), each as NN.asf and NN_MM.amc; docs/evidence lists them. Set SINEW_DATA, or give --data, to the folder around it. Without it `reproduce annealing` and `reproduce coarse-to-fine` run, on a synthetic walk",
        data.display()
    )
}

/// Where a study writes, and what it reads.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct Places {
    /// Folder for models, cells, tables and figures [default: under target, by the name of the study]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    pub(crate) data: Option<PathBuf>,
}

impl Places {
    /// The folder of the study, made; `name` is its place under `target`.
    pub(crate) fn folder(&self, root: &Path, name: &str) -> Outcome<PathBuf> {
        let folder = self.out.clone().unwrap_or_else(|| root.join("target").join(name));
        std::fs::create_dir_all(&folder)?;
        Ok(folder)
    }

    /// The folder of the recordings, whether it is there or not.
    pub(crate) fn data(&self, root: &Path) -> PathBuf {
        // Where there was no command line, the environment has not been read.
        let named = || std::env::var_os("SINEW_DATA").map(PathBuf::from);
        self.data.clone().or_else(named).unwrap_or_else(|| root.join("../shared/data"))
    }
}

/// Cells that run at a time.
pub(crate) fn threads(given: Option<usize>) -> usize {
    given.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()))
}

/// What a study of cells takes.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct StudyOptions {
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    pub(crate) threads: Option<usize>,
    #[command(flatten)]
    places: Places,
}

impl StudyOptions {
    /// Cells that run at a time.
    pub(crate) fn threads(&self) -> usize {
        threads(self.threads)
    }

    /// [`Places::folder`].
    pub(crate) fn folder(&self, root: &Path, name: &str) -> Outcome<PathBuf> {
        self.places.folder(root, name)
    }

    /// [`Places::data`].
    pub(crate) fn data(&self, root: &Path) -> PathBuf {
        self.places.data(root)
    }

    /// The folder of recordings that a study learns from.
    ///
    /// # Errors
    /// A folder without them.
    pub(crate) fn recordings(&self, root: &Path) -> Outcome<PathBuf> {
        let data = self.data(root);
        match data.join("cmu_amc").is_dir() {
            true => Ok(data),
            false => Err(no_recordings(&data).into()),
        }
    }
}

/// What a study of the whole program takes.
#[derive(clap::Args, Clone, Debug, Default)]
pub(crate) struct ProgramOptions {
    /// The program `sinew` [default: it is built]
    #[arg(long)]
    program: Option<PathBuf>,
    #[command(flatten)]
    places: Places,
}

impl ProgramOptions {
    /// The program, working in the folder of the study, which is made.
    pub(crate) fn program(&self, root: &Path, name: &str) -> Outcome<Program> {
        let path = self.program.clone().map_or_else(|| built(root), Ok)?;
        Ok(Program { path, folder: self.places.folder(root, name)? })
    }

    /// [`Places::folder`].
    pub(crate) fn folder(&self, root: &Path, name: &str) -> Outcome<PathBuf> {
        self.places.folder(root, name)
    }

    /// [`Places::data`].
    pub(crate) fn data(&self, root: &Path) -> PathBuf {
        self.places.data(root)
    }
}
