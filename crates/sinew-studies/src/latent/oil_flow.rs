//! `cargo xtask study oil-flow`: GPLVMs of the oil flow data from five starts, the table of docs/evidence/latent.md.

use crate::support::outcome::Outcome;
use crate::support::table::{header, row};
use sinew::core::lanes::Isa;
use sinew::latent::training::{Config, Training};
use sinew_tests::data;
use sinew_tests::oil_flow::OilFlow;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Folder of the table [default: target/oil-flow]
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Rows, and what GPy reached of them: log likelihood, errors of the nearest neighbour.
const SIZES: [(usize, f64, usize); 2] = [(100, 934.48, 2), (400, 5641.05, 4)];
/// Factors on the principal components that learning starts from.
const STARTS: [f64; 5] = [1.0, 0.5, 2.0, 0.25, 4.0];
/// Variance of the radial basis function at the start, that of the columns.
const VARIANCE: f64 = 0.1;
const STEPS: usize = 10_000;

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let out = args.out.clone().unwrap_or_else(|| root.join("target/oil-flow"));
    let folder = data::folder().join("oil_flow");
    let mut table =
        header("| >rows | start | >log likelihood | >above GPy's | >nearest-neighbour errors | >steps | >time, s |");
    for (count, gpy, gpy_errors) in SIZES {
        let oil = OilFlow::read(&folder, count)?;
        let model = oil.model()?;
        let errors = oil.neighbour_errors(&model.nodes[0].latents);
        row!(table, "{count} | principal components alone | | | {errors} | |");
        row!(table, "{count} | GPy | {gpy:.2} | | {gpy_errors} | |");
        for factor in STARTS {
            let mut start = model.clone();
            start.nodes[0].latents.iter_mut().for_each(|x| *x *= factor);
            start.nodes[0].covariance.variance = VARIANCE;
            let began = Instant::now();
            let mut training =
                Training::new(start, Config { steps: STEPS, steepness: 1e-8, ..Config::default() }, Isa::best())?;
            let end = training.run(|_| true);
            let (reached, errors) = (-end.objective, oil.neighbour_errors(&training.into_model().nodes[0].latents));
            let seconds = began.elapsed().as_secs_f64();
            let row = format!(
                "| {count} | principal components × {factor} | {reached:.2} | {:+.2} | {errors} | {} | {seconds:.1} |",
                reached - gpy,
                end.steps
            );
            println!("{row}");
            writeln!(table, "{row}")?;
        }
    }
    std::fs::create_dir_all(&out)?;
    std::fs::write(out.join("table.md"), table)?;
    Ok(())
}
