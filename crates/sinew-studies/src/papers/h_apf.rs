//! Raskin, Rudzsky & Rivlin (2007, 2011): annealed tracking in latent spaces of poses. In a single one it is GPAPF, down a hierarchy of them H-APF.
//!
//! | file | what |
//! |---|---|
//! | [`motions`] | what is learned from and tracked |
//! | [`lessons`] | training motion, and latent models learned from it once |
//! | [`reconstruction`] | how well poses come back from a latent space |
//! | [`pilot`] | is anybody followed at all, on training motion |
//! | [`contender`], [`trackers`] | who is compared, and how each is made of what was learned |
//! | [`track`], [`study`] | one run and what its estimates are worth; all of them |
//! | [`coverage`] | intervals of the trackers' sets where the posterior is known |
//! | [`results`] | means and differences over several motions, losses and recoveries |
//! | [`claims`], [`tables`], [`figures`], [`poses`] | the paper's claims and what became of them; tables; errors over time; a run and martial arts as figures |

mod claims;
mod contender;
mod coverage;
mod figures;
mod lessons;
mod motions;
mod pilot;
mod poses;
mod reconstruction;
mod results;
mod study;
mod tables;
mod track;
mod trackers;

use super::seed_results::Results;
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use crate::support::study_options::StudyOptions;
use crate::support::table::{header, row};
use contender::{Contender, Method, Motion, PRINTED};
use coverage::COVERAGE;
use motions::{FAST_HZ, RATE_HZ};
use std::fmt::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use study::Study;

/// Reproduces the trackers in latent spaces.
#[derive(clap::Args)]
pub(super) struct Args {
    /// Follow a walk of training that nothing was learned from, with three seeds, to see whether anybody is followed at all
    #[arg(long)]
    pilot: bool,
    /// A reduced size in half a minute
    #[arg(long, conflicts_with = "pilot")]
    quick: bool,
    /// Seeds from 1 on, each another person, other noise and other particles
    #[arg(long, default_value_t = 7)]
    seeds: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Series of the coverage, by contender and size.
const SERIES: usize = 40;

/// The walk that the reduced size tracks.
const QUICK: Motion = Motion::Walk(1);

/// One walk with one seed, by the hierarchy, CONDENSATION and the mean pose: a table, a figure, and whether the first is nearer than the second.
fn reduced(
    study: &Study,
    store: &mut Store,
    contenders: &[Contender],
    (folder, threads): (&Path, usize),
) -> Outcome<ExitCode> {
    const QUICK_SERIES: usize = 4;
    COVERAGE.run(store, QUICK_SERIES, threads)?;
    study.run_all(store, contenders, 1, threads)?;
    let results = Results { store, seeds: 1, block: RATE_HZ as usize };
    let mut errors = vec![];
    let mut text = format!("## {}\n\n", QUICK.name()) + &header("| method | >absolute error, mm |");
    for Contender { method, .. } in contenders {
        errors.push(results.over(*method, &[QUICK], "/absolute")?.value);
        row!(text, "{} | {:.0}", method.name(), errors[errors.len() - 1]);
    }
    let _ = writeln!(text, "\n## Coverage\n\n{}", COVERAGE.table(store, QUICK_SERIES)?);
    std::fs::write(folder.join("tables.md"), &text)?;
    figures::walk(&results, (QUICK, contenders), folder)?;
    println!("{text}\ntables and figure in {}", folder.display());
    println!("reduced size: verdicts need the full run; asserted is that the hierarchy is nearer");
    Ok(if errors[0] < errors[1] { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Tables and claims as Markdown, the claims alone second.
fn report(study: &Study, store: &Store, seeds: u64) -> Outcome<[String; 2]> {
    let results = Results { store, seeds, block: RATE_HZ as usize };
    let fast = Results { block: FAST_HZ as usize, ..results };
    let claims = super::claim::table(&claims::judge(&results, study)?);
    let lessons = || study.lessons.iter().map(|(lesson, (taught, _))| (*lesson, taught));
    let mut text = String::new();
    for (_, taught) in lessons() {
        let fits = taught.poses.errors_m.iter().map(|(name, error)| format!("{name} {:.1}", 1e3 * error));
        let _ = writeln!(text, "Fit of the body, mm: {}\n", fits.collect::<Vec<_>>().join(", "));
    }
    let off = results.off_manifold(PRINTED[1], &contender::walks())?;
    let _ = writeln!(text, "Particles of GPAPF off the manifold on the walks: {:.2} %\n", 100.0 * off);
    let [paper, pilot] = tables::on_walks(&results)?;
    let tables = [
        ("Walks at 15 frames a second, the paper's particles", paper),
        ("The same, 1000 particles", pilot),
        ("Frame rates", tables::rates(&results, &fast)?),
        ("Several motions, and unseen ones", tables::others(&results)?),
        ("CMB by phase", tables::phases(&results, study)?),
        ("Recovery", tables::recovery(&results)?),
        ("Runs at 15 frames a second", tables::on_runs(&results)?),
        ("Models", tables::models(lessons())?),
        ("Noise of the place", tables::noise(lessons())),
        ("Coverage", COVERAGE.table(store, SERIES)?),
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
    let name = if args.quick { "reproduce/h-apf-quick" } else { "reproduce/h-apf" };
    let folder = args.options.folder(root, name)?;
    let threads = args.options.threads();
    if args.pilot {
        let text = pilot::pilot(&data, &folder, threads)?;
        std::fs::write(folder.join("pilot.md"), &text)?;
        println!("{text}");
        return Ok(ExitCode::SUCCESS);
    }
    let quick = [PRINTED[0], PRINTED[3], Method::MeanPose].map(|method| Contender { method, motion: QUICK });
    let contenders = if args.quick { quick.to_vec() } else { contender::all() };
    let study = Study::new(&data, &folder, &contenders)?;
    let mut store = Store::open(&folder, &study.configuration())?;
    if args.quick {
        return reduced(&study, &mut store, &contenders, (&folder, threads));
    }
    COVERAGE.run(&mut store, SERIES, threads)?;
    study.run_all(&mut store, &contenders, args.seeds, threads)?;
    let [tables, claims] = report(&study, &store, args.seeds)?;
    std::fs::write(folder.join("tables.md"), &tables)?;
    std::fs::write(folder.join("claims.md"), &claims)?;
    let results = Results { store: &store, seeds: args.seeds, block: RATE_HZ as usize };
    figures::all(&results, &folder)?;
    poses::figure_4(&study, &folder)?;
    println!("{tables}\n{claims}\n{:.0} s; cells and tables in {}", clock.elapsed().as_secs_f64(), folder.display());
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use crate::papers::reduced_size;

    /// The whole command in a reduced size: on a walk the hierarchy is nearer than CONDENSATION.
    #[test]
    fn the_reduced_study_holds() {
        if sinew_tests::data::shared("cmu_amc_35").is_none() {
            return;
        }
        reduced_size::holds("h-apf", &["tables.md", "figure-1.svg"]);
    }
}
