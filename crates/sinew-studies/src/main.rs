//! Studies: what measures the product and reproduces papers. `cargo xtask study <name>` runs them.
//!
//! | room | what |
//! |---|---|
//! | [`papers`] | `reproduce`: a module for each paper, and what they share: scenes, claims, results by seed |
//! | [`accuracy`], [`trackers`] | distance to references, by cameras, cost and method; real masks |
//! | [`coverage`], [`intervals`] | do intervals hold what they promise: on simulated people; on cameras that are left out |
//! | [`identifiability`], [`filter_priors`], [`motion_prior`] | what data say of constants; priors between frames |
//! | [`people`], [`clocks`], [`gait`], [`opensim`] | several people, lags of cameras, events of gait, joint angles beside OpenSim |
//! | [`latent`] | latent models on published data |
//! | [`batch`], [`soak`], [`checksums`], [`report_check`] | many trials, long runs, results at fixed seeds, the page in a browser |
//! | [`verify`], [`tables`], [`picture`] | statistical checks; tables and pictures of the pages |
//! | [`support`] | kept cells, the program, options, charts, tables, means and verdicts |
//!
//! `peers` beside this folder holds other people's programs on the same data. What is measured here is computed by the product or by the tests' library; a study runs, judges and prints.

mod accuracy;
mod batch;
mod checksums;
mod clocks;
mod coverage;
mod filter_priors;
mod gait;
mod identifiability;
mod intervals;
mod latent;
mod motion_prior;
mod opensim;
mod papers;
mod people;
mod picture;
mod report_check;
mod soak;
mod support;
mod tables;
mod trackers;
mod verify;

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use support::outcome::exit_code;

/// Studies of the product.
#[derive(Parser)]
#[command(name = "cargo xtask study")]
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
    MissingLimbs(latent::missing_limbs::Args),
    /// Measure how often intervals hold the truth of simulated people: the tables and figures of docs/evidence/coverage.md.
    Coverage(coverage::Args),
    /// Measure what a learned motion model is worth as a prior on keypoints: the tables of docs/evidence/experiments/motion-prior.md.
    MotionPrior(motion_prior::Args),
    /// Learn GPLVMs of the oil flow data: a table of docs/evidence/latent.md.
    OilFlow(latent::oil_flow::Args),
    /// Compare joint angles with OpenSim's inverse kinematics on the same markers: the tables of docs/evidence/opensim.md.
    Opensim(opensim::Args),
    /// Draw docs/images/demo.svg and real.png, the pictures of the guide and the README.
    Picture,
    /// Open a page of `sinew report` in a headless browser, with and without WebGL, and judge it.
    ReportCheck(report_check::Args),
    /// Reproduce a paper: its tables and figures on our data, its claims judged.
    Reproduce(papers::Args),
    /// Track real masks by all methods: the tables of docs/evidence/experiments/real-silhouettes.md.
    Silhouettes(trackers::silhouettes::Args),
    /// Track 100 000 frames and see whether memory, time a frame, open files and errors stay what they were.
    Soak(soak::Args),
    /// Measure how well clocks of cameras are found, and what a lag costs: the tables of docs/evidence/sync.md.
    Sync(clocks::Args),
    /// Put tables into the pages of docs: tables of the code, and tables that commands have written under target.
    Tables,
    /// Track the same recordings by all trackers: the tables of docs/reference/trackers.md.
    Trackers(trackers::Args),
    /// Run every statistical check: does each claim of docs/evidence/correctness.md hold?
    Verify(verify::Args),
}

fn main() -> ExitCode {
    let root = support::root();
    let done = match Cli::parse().command {
        Command::Accuracy(args) => accuracy::run(root, &args),
        Command::Batch(args) => batch::run(root, &args),
        Command::Checksums(args) => checksums::run(root, &args),
        Command::FilterPriors(args) => filter_priors::run(root, &args),
        Command::Gait(args) => gait::run(root, &args),
        Command::Identifiability(args) => identifiability::run(root, &args),
        Command::People(args) => people::run(root, &args),
        Command::Intervals(args) => intervals::run(root, &args),
        Command::MissingLimbs(args) => latent::missing_limbs::run(root, &args),
        Command::Coverage(args) => coverage::run(root, &args),
        Command::MotionPrior(args) => motion_prior::run(root, &args),
        Command::OilFlow(args) => latent::oil_flow::run(root, &args),
        Command::Opensim(args) => opensim::run(root, &args),
        Command::Picture => picture::run(root),
        Command::ReportCheck(args) => report_check::run(&args),
        Command::Reproduce(args) => return exit_code(papers::run(root, &args)),
        Command::Silhouettes(args) => trackers::silhouettes::run(root, &args),
        Command::Soak(args) => return exit_code(soak::run(&args)),
        Command::Sync(args) => clocks::run(root, &args),
        Command::Tables => tables::run(root),
        Command::Trackers(args) => trackers::run(root, &args),
        Command::Verify(args) => return verify::run(root, &args),
    };
    exit_code(done.map(|()| ExitCode::SUCCESS))
}
