//! Husz, Wallace & Green (2007): the hierarchical partitioned particle filter with action primitives.
//!
//! | file | what |
//! |---|---|
//! | [`motions`] | frame rates, and what the pilot learns from and tracks |
//! | [`models`] | motion models, learned once |
//! | [`pilot`] | is anybody followed at all, on training motion |
//! | [`contender`] | who is compared |
//! | [`track`], [`study`] | one run and what its estimates are worth; all of them |
//! | [`coverage`] | intervals of the tracker's set where the posterior is known |
//! | [`results`] | errors and differences over test trials |
//! | [`claims`], [`tables`], [`figures`] | the paper's claims and what became of them; its tables; a figure of actions |

mod claims;
mod contender;
mod coverage;
mod figures;
mod models;
mod motions;
mod pilot;
mod results;
mod study;
mod tables;
mod track;

use super::recorded_trials::TRAINING;
use super::seed_results::Results;
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::store::Store;
use crate::support::study_options::StudyOptions;
use crate::support::table::{header, row};
use contender::{Motion, on};
use coverage::COVERAGE;
use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use study::Study;

/// Reproduces the hierarchical partitioned particle filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Follow training motion instead, with three seeds, to see whether anybody is followed at all
    #[arg(long)]
    pilot: bool,
    /// A reduced size in half a minute
    #[arg(long, conflicts_with = "pilot")]
    quick: bool,
    /// Only the test trials and the table of ablations and opponents on them
    #[arg(long, conflicts_with_all = ["pilot", "quick"])]
    trials: bool,
    /// Seeds from 1 on, each another person, other noise and other particles
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Series of the coverage, by contender and size.
const SERIES: usize = 40;

/// Trials that the reduced size learns from: walks of the person who is tracked.
const QUICK_TRIALS: usize = 5;

/// The walk with one seed: the tracker, and what it is to be better than; coverage on few series. Tables, a figure, and whether it is kept and better.
fn reduced(study: &Study, store: &mut Store, folder: &Path, threads: usize) -> Outcome<ExitCode> {
    const QUICK_SERIES: usize = 8;
    let [usual, random, mean_pose] =
        [contender::USUAL, contender::OPPONENTS[0], contender::REFERENCES[0]].map(|m| on(m, Motion::Walk));
    COVERAGE.run(store, QUICK_SERIES, threads)?;
    study.run_all(store, &[usual, random, mean_pose], 1, threads)?;
    let results = Results { store, seeds: 1, block: motions::RATE_HZ as usize };
    let mut text = format!("## {}\n\n", Motion::Walk.name()) + &header("| method | >absolute error, mm | kept |");
    let mut found = vec![];
    for contender in [usual, random, mean_pose] {
        let (error, kept) = (results.mean(&contender, "/absolute", None)?.value, results.kept(&contender)?.1 == 1);
        row!(text, "{} | {error:.0} | {}", contender.method.name(), if kept { "yes" } else { "no" });
        found.push((error, kept));
    }
    let _ = writeln!(text, "\n## Coverage\n\n{}", COVERAGE.table(store, QUICK_SERIES)?);
    std::fs::write(folder.join("tables.md"), &text)?;
    let figure = figures::actions(store, &study.scenes[&Motion::Walk].tree, Motion::Walk)?;
    std::fs::write(folder.join("figure-actions.svg"), figure)?;
    println!("{text}\ntables and figure in {}", folder.display());
    println!("reduced size: verdicts need the full run; asserted is that the walk is kept and nearer than at random");
    Ok(if found[0].1 && found[0].0 < found[1].0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Tables and claims as Markdown, the claims alone second.
fn report(study: &Study, results: &Results<'_>) -> Outcome<[String; 2]> {
    let fits = study.training.errors_m.iter().map(|(_, error)| 1e3 * error).collect::<Vec<f64>>();
    let claims = super::claim::table(&claims::judge(results, study)?);
    let mut text = format!(
        "Fit of the body to the joints, mm: training {:.1} on average; {}\n\n",
        mean(&fits),
        contender::PRINTED
            .map(|motion| format!("{} {:.1}", motion.name(), 1e3 * study.scenes[&motion].fit_error_m))
            .join(", ")
    );
    let tables = [
        ("Table 1", tables::table_1(results, study)?),
        ("Table 2", tables::table_2(results, study)?),
        ("Table 3", tables::table_3(results)?),
        ("Table 4", tables::table_4(results)?),
        ("Ablations and opponents on CMB", tables::beside(results)?),
        ("Test trials", tables::trials(results)?),
        ("Coverage", COVERAGE.table(results.store, SERIES)?),
    ];
    for (title, table) in tables {
        let _ = writeln!(text, "## {title}\n\n{table}");
    }
    Ok([text, claims])
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.options.recordings(root)?;
    let name = if args.quick { "reproduce/hppf-quick" } else { "reproduce/hppf" };
    let folder = args.options.folder(root, name)?;
    if args.pilot {
        let text = pilot::pilot(&data, &folder)?;
        std::fs::write(folder.join("pilot.md"), &text)?;
        println!("{text}");
        return Ok(ExitCode::SUCCESS);
    }
    let study = match args.quick {
        true => Study::new(&data, &folder, &TRAINING[..QUICK_TRIALS], &[Motion::Walk])?,
        false => Study::new(&data, &folder, &TRAINING, &Motion::all())?,
    };
    let mut store = Store::open(&folder, &study.configuration())?;
    let threads = args.options.threads();
    if args.quick {
        return reduced(&study, &mut store, &folder, threads);
    }
    if args.trials {
        study.run_all(&mut store, &contender::trials(), args.seeds, threads)?;
        let table = tables::trials(&Results { store: &store, seeds: args.seeds, block: motions::RATE_HZ as usize })?;
        std::fs::write(folder.join("trials.md"), &table)?;
        println!("{table}\n{:.0} s; cells and the table in {}", clock.elapsed().as_secs_f64(), folder.display());
        return Ok(ExitCode::SUCCESS);
    }
    COVERAGE.run(&mut store, SERIES, threads)?;
    study.run_all(&mut store, &contender::all(), args.seeds, threads)?;
    let results = Results { store: &store, seeds: args.seeds, block: motions::RATE_HZ as usize };
    let [tables, claims] = report(&study, &results)?;
    std::fs::write(folder.join("trials.md"), tables::trials(&results)?)?;
    std::fs::write(folder.join("tables.md"), &tables)?;
    std::fs::write(folder.join("claims.md"), &claims)?;
    match figures::actions(&store, &study.scenes[&Motion::Combo].tree, Motion::Combo) {
        Ok(figure) => std::fs::write(folder.join("figure-actions.svg"), figure)?,
        Err(why) => eprintln!("figure-actions.svg is not drawn: {why}"),
    }
    println!("{tables}\n{claims}\n{:.0} s; cells and tables in {}", clock.elapsed().as_secs_f64(), folder.display());
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use crate::papers::reduced_size;

    /// The whole command in a reduced size: the walk is kept, and by action primitives it is nearer than at random.
    #[test]
    fn the_reduced_study_holds() {
        if sinew_tests::data::shared("cmu_amc_35").is_none() {
            return;
        }
        reduced_size::holds("hppf", &["tables.md", "figure-actions.svg"]);
    }
}
