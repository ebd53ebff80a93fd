//! Chores of the workspace: `cargo xtask <command>`. This file is the whole command line; each command has a file of its own.

mod accuracy;
mod calibration;
mod chart;
mod picture;
mod reproduce;
mod source;
mod store;
mod tidy;

use clap::{Parser, Subcommand};
use std::path::Path;
use std::process::ExitCode;

/// Chores of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Measure accuracy and coverage: the tables of docs/accuracy.md.
    Accuracy(accuracy::Args),
    /// Measure calibration on people: the tables and figures of docs/calibration.md.
    Calibration(calibration::Args),
    /// Draw docs/images/demo.svg, the picture of the README.
    Picture,
    /// Reproduce a paper: its tables and figures on our data, its claims judged.
    Reproduce(reproduce::Args),
    /// Check the rules that docs/ARCHITECTURE.md states: layers, who may do IO, leftovers, module docs.
    Tidy,
}

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    match Cli::parse().command {
        Command::Accuracy(args) => accuracy::run(root, &args),
        Command::Calibration(args) => calibration::run(root, &args),
        Command::Picture => picture::run(root),
        Command::Reproduce(args) => reproduce::run(root, &args),
        Command::Tidy => tidy::run(root),
    }
}
