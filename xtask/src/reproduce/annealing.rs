//! Annealing by the numbers of its settings (Deutscher, Blake & Reid 2000; Deutscher & Reid 2005; Balan, Sigal & Black 2005), beside the filters that it is compared with: what is swept, and what its weighted set says of a
//! posterior.
//!
//! | file | what |
//! |---|---|
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
mod tables;
mod walk;

use crate::store::{Store, Task, rows, run_all};
use clap::ValueEnum;
use film::{Film, Method, Row, SCORES};
use serde_json::{Value, json};
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use walk::Walks;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Parts of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Coverage of intervals on linear-Gaussian series.
    Coverage,
    /// Particles against the number of parts.
    Partitions,
    /// Variance of resampling schemes.
    Schemes,
    /// Sweeps on silhouettes of a walk.
    Film,
}

/// Sweeps of annealed, partitioned and bootstrap tracking.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in half a minute
    #[arg(long)]
    quick: bool,
    /// Parts to run, separated by commas [default: all]
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Folder for cells, tables and figures [default: target/reproduce/annealing]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seeds of the film [default: all of the size]
    #[arg(long)]
    seeds: Option<usize>,
    /// Seed of the first run
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// How much is run.
#[derive(Clone, Debug)]
struct Size {
    /// Series of each dimension, and particles of the bootstrap filter.
    series: usize,
    particles: usize,
    dims: Vec<usize>,
    /// Runs a number of parts, and the largest number of parts.
    part_runs: usize,
    most_parts: usize,
    /// Weighted sets or runs of the schemes.
    repeats: usize,
    /// Frames and seeds of the film, and the sweeps that are run on it.
    frames: usize,
    seeds: usize,
    sweeps: &'static [&'static str],
}

impl Size {
    fn full() -> Self {
        Self {
            series: 40,
            particles: 20_000,
            dims: coverage::DIMS.to_vec(),
            part_runs: 20,
            most_parts: 8,
            repeats: 400,
            frames: 41,
            seeds: 5,
            sweeps: &["survival rate", "layers", "variants", "presets", "filters"],
        }
    }

    fn quick() -> Self {
        Self {
            series: 8,
            particles: 3000,
            dims: vec![2, 6],
            part_runs: 10,
            most_parts: 4,
            repeats: 60,
            frames: 5,
            seeds: 1,
            sweeps: &["presets"],
        }
    }
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;

/// What runs, and what was found of it.
struct Study {
    size: Size,
    seed: u64,
    isa: Isa,
    rows: Vec<Row>,
    /// Cells of the series and of the film.
    store: Store,
    film: Store,
    only: Vec<Part>,
}

fn film_key(score: &str, method: &Method, index: usize) -> String {
    format!("film/{score}/{method:?}/{index}")
}

impl Study {
    fn wanted(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }

    fn contenders(&self) -> Vec<(String, coverage::Contender)> {
        coverage::contenders(self.size.particles)
    }

    /// Survival rates with their numbers of parts.
    fn rates(&self) -> Vec<(f64, usize)> {
        partitions::RATES.into_iter().map(|(rate, most)| (rate, most.min(self.size.most_parts))).collect()
    }

    fn value(&self, key: &str) -> Outcome<&Value> {
        self.store.get(key).or_else(|| self.film.get(key)).ok_or_else(|| format!("{key} is missing").into())
    }

    /// Means with errors of the columns of [`coverage`].
    fn covered(&self, name: &str, dim: usize) -> Outcome<Vec<[f64; 2]>> {
        Ok(coverage::summary(&rows(self.value(&format!("coverage/{dim}/{name}"))?)))
    }

    /// Particles and evaluations of parts that are needed for 1, 2, … parts, `at_once` or `apart`.
    fn needed(&self, rate: f64, most: usize, how: &str) -> Outcome<Vec<[f64; 2]>> {
        let of = |dim: usize| {
            let value = &self.value(&format!("partitions/{rate}/{dim}"))?[how];
            Ok([0, 1].map(|k: usize| value[k].as_f64().unwrap_or(f64::NAN)))
        };
        (1..=most).map(of).collect()
    }

    fn scheme_rows(&self, case: usize) -> Outcome<Vec<Vec<f64>>> {
        Ok(rows(self.value(&format!("schemes/{case}"))?))
    }

    /// The cells of a row of the film, seed by seed.
    fn filmed(&self, score: &str, method: &Method) -> Outcome<Vec<&Value>> {
        (0..self.size.seeds).map(|index| self.value(&film_key(score, method, index))).collect()
    }
}

/// Runs what is missing of the parts without pictures.
fn run_series(study: &mut Study, threads: usize) -> Outcome<()> {
    let (seed, isa) = (study.seed, study.isa);
    let mut tasks: Vec<Task<'_>> = vec![];
    if study.wanted(Part::Coverage) {
        for (name, contender) in study.contenders() {
            for &dim in &study.size.dims {
                let (contender, series) = (contender.clone(), study.size.series);
                let task = move || coverage::cell(&contender, dim, series, seed, isa);
                tasks.push((format!("coverage/{dim}/{name}"), 1.0, Box::new(task)));
            }
        }
    }
    if study.wanted(Part::Partitions) {
        for (rate, most) in study.rates() {
            for dim in 1..=most {
                let runs = study.size.part_runs;
                let task = move || {
                    let stage = Stage::new(seed, "annealing partitions").round(dim);
                    partitions::cell(rate, dim, runs, &stage)
                };
                tasks.push((format!("partitions/{rate}/{dim}"), rate.powi(-(dim as i32)) / 1e3, Box::new(task)));
            }
        }
    }
    if study.wanted(Part::Schemes) {
        for case in 0..schemes::CASES.len() {
            let repeats = study.size.repeats;
            let task = move || schemes::cell(case, repeats, &Stage::new(seed, "annealing schemes").round(case));
            tasks.push((format!("schemes/{case}"), 1.0, Box::new(task)));
        }
    }
    run_all(&mut study.store, "series", tasks, threads)
}

/// Runs what is missing of the film, seed by seed, so that a run that is stopped has whole seeds.
fn run_film(study: &mut Study, film: &Film<'_>, threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for index in 0..film.seeds() {
        for (score, bidirectional) in SCORES {
            for Row { method, .. } in study.rows.iter().filter(|row| row.is_run_with(score)) {
                let (key, method) = (film_key(score, method, index), method.clone());
                if tasks.iter().all(|(other, ..)| *other != key) {
                    let task = move || film.cell(&method, bidirectional, index);
                    tasks.push((key, 1.0, Box::new(task)));
                }
            }
        }
    }
    run_all(&mut study.film, "film", tasks, threads)
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    let walks = Walks::new(&data)?;
    let mut size = if args.quick { Size::quick() } else { Size::full() };
    let name = if args.quick { "annealing-quick" } else { "annealing" };
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/reproduce").join(name));
    let (isa, seed) = (Isa::best(), args.seed);
    let of_all = format!("version {VERSION}, {}, seed {seed}", isa.name());
    // A seed of the film is a cell of its own, and its sweeps are named by what they run.
    let of_film = format!("{of_all}, film, {} frames, {:016x}", size.frames, walks.hash());
    let of_series = format!("{of_all}, series, {:?}", (size.series, size.particles, size.part_runs, size.repeats));
    size.seeds = args.seeds.unwrap_or(size.seeds);
    let rows: Vec<Row> = film::rows().into_iter().filter(|row| size.sweeps.contains(&row.sweep)).collect();
    let store = Store::open(&folder, &of_series)?;
    let film_store = Store::open(&folder, &of_film)?;
    let film = Film::new(&walks, size.frames, size.seeds, seed, isa)?;
    let mut study = Study { size, seed, isa, rows, store, film: film_store, only: args.only.clone() };
    let granted = std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = args.threads.unwrap_or(granted);
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
    let described =
        json!({ "walk": walks.test.name, "fit_mm": [absolute, relative], "scale": walks.test.scale, "sd": walks.sd });
    tables::write(&study, &judged, &described, &folder)?;
    figures::draw(&study, &folder)?;
    println!("{}", tables::expectations(&judged));
    println!("{:.0} s; cells, tables and figures in {}", clock.elapsed().as_secs_f64(), folder.display());
    if args.quick {
        println!(
            "reduced size: verdicts are those of the full run only; asserted are E3, annealed sets below 80 %, filters within 80–98 %, and that the walk is tracked"
        );
        let failed = expectations::reduced(&study, &judged)?;
        failed.iter().for_each(|what| println!("does not hold: {what}"));
        return Ok(if failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole command in a reduced size: files are written, annealed sets are too narrow and filters' sets are not, parts need what the laws say, and the walk is followed.
    #[test]
    fn the_reduced_study_holds() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let out = std::env::temp_dir().join(format!("sinew-annealing-{}", std::process::id()));
        let data = std::env::var_os("SINEW_DATA").map(PathBuf::from);
        let args =
            Args { quick: true, only: vec![], out: Some(out.clone()), seeds: None, seed: 1, threads: None, data };
        assert_eq!(run(root, &args).unwrap(), ExitCode::SUCCESS, "what does not hold is printed above");
        assert!(out.join("cells.jsonl").is_file() && std::fs::read_dir(&out).unwrap().count() > 8);
        std::fs::remove_dir_all(&out).unwrap();
    }
}
