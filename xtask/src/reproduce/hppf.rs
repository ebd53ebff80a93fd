//! Husz, Wallace & Green (2007): the hierarchical partitioned particle filter with action primitives.
//!
//! | file | what |
//! |---|---|
//! | [`motions`] | recordings to learn from and to track |
//! | [`models`] | motion models, learned once |
//! | [`scene`] | a motion, its body, what cameras see |
//! | [`worth`] | errors, and whether the person is kept |
//! | [`pilot`] | is anybody followed at all, on training motion |

mod models;
mod motions;
mod pilot;
mod scene;
mod worth;

use crate::outcome::Outcome;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Reproduces the hierarchical partitioned particle filter; of the study only the pilot is there.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Only variants whose name has this in it
    #[arg(long)]
    only: Option<String>,
    /// Folder for models and tables [default: target/reproduce/hppf]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    if !data.join("cmu_amc").is_dir() {
        return Err(format!("no recordings in {}: the study learns from them", data.display()).into());
    }
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/reproduce/hppf"));
    std::fs::create_dir_all(&folder)?;
    let text = pilot::pilot(&data, &folder, args.only.as_deref())?;
    std::fs::write(folder.join("pilot.md"), &text)?;
    println!("{text}");
    Ok(ExitCode::SUCCESS)
}
