//! Chores of the workspace: `cargo xtask <command>`. This file is the whole command line; each command has a file of its own.

mod accuracy;
mod batch;
mod chart;
mod checksums;
mod coverage;
mod filter_priors;
mod gait;
mod identifiability;
mod intervals;
mod missing_limbs;
mod motion_prior;
mod mutants;
mod oil_flow;
mod opensim;
mod outcome;
mod people;
mod people_real;
mod picture;
mod processor_time;
mod program;
mod report_check;
mod reproduce;
mod silhouettes;
mod soak;
mod source;
mod store;
mod study_options;
mod sync;
mod tables;
mod tidy;
mod trackers;
mod verify;

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
    /// Measure accuracy and coverage: the tables of docs/evidence/accuracy.md.
    Accuracy(accuracy::Args),
    /// Measure what many trials cost beside their tracking, and simulate a cluster: the tables of docs/evidence/batch.md.
    Batch(batch::Args),
    /// Hold results at fixed seeds against the checksums of tests/checksums.tsv, before and after a rebuilding.
    Checksums(checksums::Args),
    /// Measure the HMC filter's priors between frames against exact filters: the tables of docs/evidence/filter-priors.md.
    FilterPriors(filter_priors::Args),
    /// Measure how well gait is read from tracked walkers: the tables of docs/evidence/gait.md.
    Gait(gait::Args),
    /// Measure how far data tell the constants of a set-up apart: the tables of docs/evidence/identifiability.md.
    Identifiability(identifiability::Args),
    /// Measure how well several people are kept apart: the tables of docs/evidence/people.md.
    People(people::Args),
    /// Judge intervals by cameras that are left out and by demos: the tables of docs/evidence/intervals.md.
    Intervals(intervals::Args),
    /// Fill in missing limbs by latent models: the tables of docs/evidence/latent.md.
    MissingLimbs(missing_limbs::Args),
    /// Plant the bugs of tests/planted in a copy of the workspace and name the test that catches each.
    Mutants(mutants::Args),
    /// Measure how often intervals hold the truth of simulated people: the tables and figures of docs/evidence/coverage.md.
    Coverage(coverage::Args),
    /// Measure what a learned motion model is worth as a prior on keypoints: the tables of docs/evidence/experiments/motion-prior.md.
    MotionPrior(motion_prior::Args),
    /// Learn GPLVMs of the oil flow data: a table of docs/evidence/latent.md.
    OilFlow(oil_flow::Args),
    /// Compare joint angles with OpenSim's inverse kinematics on the same markers: the tables of docs/evidence/opensim.md.
    Opensim(opensim::Args),
    /// Draw docs/images/demo.svg and real.png, the pictures of the guide and the README.
    Picture,
    /// Open a page of `sinew report` in a headless browser, with and without WebGL, and judge it.
    ReportCheck(report_check::Args),
    /// Reproduce a paper: its tables and figures on our data, its claims judged.
    Reproduce(reproduce::Args),
    /// Track real masks by all methods: the tables of docs/evidence/experiments/real-silhouettes.md.
    Silhouettes(silhouettes::Args),
    /// Track 100 000 frames and see whether memory, time a frame, open files and errors stay what they were.
    Soak(soak::Args),
    /// Measure how well clocks of cameras are found, and what a lag costs: the tables of docs/evidence/sync.md.
    Sync(sync::Args),
    /// Put tables into the pages of docs: tables of the code, and tables that commands have written under target.
    Tables,
    /// Check the rules that docs/ARCHITECTURE.md states: layers, who may do IO, leftovers, module docs.
    Tidy,
    /// Track the same recordings by all trackers: the tables of docs/reference/trackers.md.
    Trackers(trackers::Args),
    /// Run every statistical check: does each claim of docs/evidence/correctness.md hold?
    Verify(verify::Args),
}

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    match Cli::parse().command {
        Command::Accuracy(args) => accuracy::run(root, &args),
        Command::Batch(args) => batch::run(root, &args),
        Command::Checksums(args) => checksums::run(root, &args),
        Command::FilterPriors(args) => filter_priors::run(root, &args),
        Command::Gait(args) => gait::run(root, &args),
        Command::Identifiability(args) => identifiability::run(root, &args),
        Command::People(args) => people::run(root, &args),
        Command::Intervals(args) => intervals::run(root, &args),
        Command::MissingLimbs(args) => missing_limbs::run(root, &args),
        Command::Mutants(args) => mutants::run(root, &args),
        Command::Coverage(args) => coverage::run(root, &args),
        Command::MotionPrior(args) => motion_prior::run(root, &args),
        Command::OilFlow(args) => oil_flow::run(root, &args),
        Command::Opensim(args) => opensim::run(root, &args),
        Command::Picture => picture::run(root),
        Command::ReportCheck(args) => report_check::run(&args),
        Command::Reproduce(args) => reproduce::run(root, &args),
        Command::Silhouettes(args) => silhouettes::run(root, &args),
        Command::Soak(args) => soak::run(&args),
        Command::Sync(args) => sync::run(root, &args),
        Command::Tables => tables::run(root),
        Command::Tidy => tidy::run(root),
        Command::Trackers(args) => trackers::run(root, &args),
        Command::Verify(args) => verify::run(root, &args),
    }
}
