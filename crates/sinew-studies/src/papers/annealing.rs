//! Annealing by the numbers of its settings, beside the filters that it is compared with.
//!
//! Deutscher, Blake & Reid 2000; Deutscher & Reid 2005; Balan, Sigal & Black 2005: what is swept, and what the weighted set says of a posterior.
//!
//! | file | what |
//! |---|---|
//! | [`study`] | how much is run, the cells, and what they hold |
//! | [`walk`] | the walk as the tracker's body makes it |
//! | [`film`] | sweeps on silhouettes: survival rate, layers, variants, named settings |
//! | [`partitions`] | particles that parts at once and one after the other need |
//! | [`schemes`] | the variance that resampling adds |
//! | [`coverage`] | how often intervals hold the truth where the posterior is known |
//! | [`expectations`] | what was expected before the run, and what came |
//! | [`tables`], [`figures`] | as files |

mod coverage;
mod expectations;
mod figures;
mod film;
mod partitions;
mod schemes;
mod study;
mod tables;
mod walk;

use crate::support::outcome::Outcome;
use crate::support::store::Store;
use crate::support::study_options::{StudyOptions, no_recordings};
use film::{Film, Row};
use sinew::core::lanes::Isa;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use study::{Part, Size, Study, VERSION, run_film, run_series};
use walk::Walks;

/// Sweeps of annealed, partitioned and bootstrap tracking.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in half a minute
    #[arg(long)]
    quick: bool,
    /// Parts to run, separated by commas [default: all]
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Seeds of the film [default: all of the size]
    #[arg(long)]
    seeds: Option<usize>,
    /// Seed of the first run
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.options.data(root);
    if !data.join("cmu_amc").is_dir() {
        println!("{}", no_recordings(&data));
    }
    let walks = Walks::new(&data)?;
    let mut size = if args.quick { Size::quick() } else { Size::full() };
    let name = if args.quick { "reproduce/annealing-quick" } else { "reproduce/annealing" };
    let folder = args.options.folder(root, name)?;
    let (isa, seed) = (Isa::best(), args.seed);
    let common = format!("version {VERSION}, {}, seed {seed}", isa.name());
    // A seed of the film is a cell of its own, and its sweeps are named by what they run.
    let film_version = format!("{common}, film, {} frames, {:016x}", size.frames, walks.hash());
    let series_version = format!("{common}, series, {:?}", (size.series, size.particles, size.part_runs, size.repeats));
    size.seeds = args.seeds.unwrap_or(size.seeds);
    let rows: Vec<Row> = film::rows().into_iter().filter(|row| size.sweeps.contains(&row.sweep)).collect();
    let store = Store::open(&folder, &series_version)?;
    let film_store = Store::open(&folder, &film_version)?;
    let film = Film::new(&walks, size.frames, size.seeds, seed, isa)?;
    let mut study = Study { size, seed, isa, rows, store, film: film_store, only: args.only.clone() };
    let threads = args.options.threads();
    run_series(&mut study, threads)?;
    if study.wanted(Part::Film) {
        run_film(&mut study, &film, threads)?;
    }
    let [absolute, relative] = film.floor();
    println!(
        "{}: the fitted body is {absolute:.1} mm from the joints, {relative:.1} mm from the pelvis",
        walks.test.name
    );
    let judged = expectations::judge(&study)?;
    tables::write(&study, &judged, &folder)?;
    figures::draw(&study, &folder)?;
    println!("{}", tables::expectations(&judged));
    println!("{:.0} s; cells, tables and figures in {}", clock.elapsed().as_secs_f64(), folder.display());
    if args.quick {
        println!(
            "reduced size: verdicts need the full run; asserted are E3, annealed sets below 80 %, filters within 80–98 %, and that the walk is tracked"
        );
        let failed = expectations::reduced(&study, &judged)?;
        failed.iter().for_each(|what| println!("does not hold: {what}"));
        return Ok(if failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use crate::papers::reduced_size;

    /// The whole command in a reduced size: files are written, annealed sets are too narrow and filters' sets are not, parts need what the laws say, and the walk is followed.
    #[test]
    fn the_reduced_study_holds() {
        reduced_size::holds(
            "annealing",
            &["cells.jsonl", "expectations.md", "coverage.svg", "partitions.svg", "film.csv"],
        );
    }
}
