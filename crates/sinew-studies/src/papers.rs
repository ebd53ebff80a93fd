//! `cargo xtask reproduce <paper>`: regenerates the tables and figures of a paper on our data and judges its claims.

mod annealing;
mod choo_fleet;
mod claim;
mod coarse_to_fine;
mod h_apf;
mod hppf;
mod interval_tally;
mod known_posterior;
mod masked_scene;
mod recorded_trials;
mod seed_results;
mod shared_values;
mod worth;

use crate::support::outcome::Outcome;
use clap::{Args as ClapArgs, Subcommand};
use std::path::Path;
use std::process::ExitCode;

#[cfg(test)]
mod reduced_size {
    //! What the tests of the papers share.

    use crate::{Cli, Command};
    use clap::Parser as _;
    use std::process::ExitCode;

    /// Runs a whole command in its reduced size: what it asserts holds, and its files are there.
    pub(super) fn holds(paper: &str, files: &[&str]) {
        let out = std::env::temp_dir().join(format!("sinew-{paper}-{}", std::process::id()));
        let [folder, data] = [&out, &sinew_tests::data::folder()].map(|path| path.display().to_string());
        let words = ["studies", "reproduce", paper, "--quick", "--out", &folder, "--data", &data];
        let Command::Reproduce(args) = Cli::parse_from(words).command else { panic!("another command") };
        let code = super::run(crate::support::root(), &args).unwrap();
        assert_eq!(code, ExitCode::SUCCESS, "what does not hold is printed above");
        for file in files {
            assert!(out.join(file).is_file(), "{file}");
        }
        std::fs::remove_dir_all(&out).unwrap();
    }
}

/// Which paper.
#[derive(ClapArgs)]
pub(crate) struct Args {
    #[command(subcommand)]
    paper: Paper,
}

#[derive(Subcommand)]
enum Paper {
    /// Deutscher, Blake & Reid, CVPR 2000, and what came of it: sweeps of annealed and partitioned tracking.
    Annealing(annealing::Args),
    /// Choo & Fleet, "People tracking using hybrid Monte Carlo filtering", ICCV 2001.
    ChooFleet(choo_fleet::Args),
    /// The coarse-to-fine particle filter with bottom-up aggregation of body parts.
    CoarseToFine(coarse_to_fine::Args),
    /// Raskin, Rudzsky & Rivlin, annealed tracking in latent spaces of poses: one (GPAPF), and a hierarchy (H-APF, 2011).
    HApf(h_apf::Args),
    /// Husz, Wallace & Green, the hierarchical partitioned particle filter with action primitives (2007).
    Hppf(hppf::Args),
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    match &args.paper {
        Paper::Annealing(args) => annealing::run(root, args),
        Paper::ChooFleet(args) => choo_fleet::run(root, args),
        Paper::CoarseToFine(args) => coarse_to_fine::run(root, args),
        Paper::HApf(args) => h_apf::run(root, args),
        Paper::Hppf(args) => hppf::run(root, args),
    }
}
