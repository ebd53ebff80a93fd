//! Husz, Wallace & Green (2007): the hierarchical partitioned particle filter with action primitives.
//!
//! | file | what |
//! |---|---|
//! | [`motions`] | recordings to learn from and to track |
//! | [`models`] | motion models, learned once |
//! | [`scene`] | a motion, its body, what cameras see |
//! | [`worth`] | errors, and whether the person is kept |
//! | [`pilot`] | is anybody followed at all, on training motion |
//! | [`contender`] | who is compared |
//! | [`track`], [`study`] | one run and what its estimates are worth; all of them |
//! | [`results`] | means, errors, paired differences |
//! | [`claims`], [`tables`], [`figures`] | the paper's claims and what became of them; its tables; a figure of actions |

mod claims;
mod contender;
mod figures;
mod models;
mod motions;
mod pilot;
mod results;
mod scene;
mod study;
mod tables;
mod track;
mod worth;

use crate::outcome::Outcome;
use crate::store::Store;
use results::Results;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use study::Study;

/// Reproduces the hierarchical partitioned particle filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Follow training motion instead, with three seeds, to see whether anybody is followed at all
    #[arg(long)]
    pilot: bool,
    /// Only variants of the pilot whose name has this in it
    #[arg(long, requires = "pilot")]
    only: Option<String>,
    /// Seeds from 1 on, each another person, other noise and other particles
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for models, cells and tables [default: target/reproduce/hppf]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Tables and claims as Markdown, the claims alone second.
fn report(study: &Study, results: &Results<'_>) -> Outcome<[String; 2]> {
    let fits = study.training_errors_m().iter().map(|(_, error)| 1e3 * error).collect::<Vec<f64>>();
    let claims = super::claim::table(&claims::judge(results, study)?);
    let mut text = format!(
        "Fit of the body to the joints, mm: training {:.1} on average; {}\n\n",
        worth::mean(&fits),
        [contender::Motion::Combo, contender::Motion::Walk, contender::Motion::Unseen1, contender::Motion::Unseen2]
            .map(|motion| format!("{} {:.1}", motion.name(), 1e3 * study.scene(motion).fit_error_m))
            .join(", ")
    );
    let tables = [
        ("Table 1", tables::table_1(results, study)?),
        ("Table 2", tables::table_2(results, study)?),
        ("Table 3", tables::table_3(results)?),
        ("Table 4", tables::table_4(results)?),
        ("Beside", tables::beside(results)?),
    ];
    for (title, table) in tables {
        let _ = writeln!(text, "## {title}\n\n{table}");
    }
    Ok([text, claims])
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    if !data.join("cmu_amc").is_dir() {
        return Err(format!("no recordings in {}: the study learns from them", data.display()).into());
    }
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/reproduce/hppf"));
    std::fs::create_dir_all(&folder)?;
    if args.pilot {
        let text = pilot::pilot(&data, &folder, args.only.as_deref())?;
        std::fs::write(folder.join("pilot.md"), &text)?;
        println!("{text}");
        return Ok(ExitCode::SUCCESS);
    }
    let study = Study::new(&data, &folder)?;
    let mut store = Store::open(&folder, &study.configuration())?;
    let threads = args.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()));
    study.run_all(&mut store, &contender::all(), args.seeds, threads)?;
    let [tables, claims] = report(&study, &Results { store: &store, seeds: args.seeds })?;
    std::fs::write(folder.join("tables.md"), &tables)?;
    std::fs::write(folder.join("claims.md"), &claims)?;
    match figures::actions(&store, &study.scene(contender::Motion::Combo).tree) {
        Ok(figure) => std::fs::write(folder.join("figure-actions.svg"), figure)?,
        Err(why) => eprintln!("figure-actions.svg is not drawn: {why}"),
    }
    println!("{tables}\n{claims}\n{:.0} s; cells and tables in {}", clock.elapsed().as_secs_f64(), folder.display());
    Ok(ExitCode::SUCCESS)
}
