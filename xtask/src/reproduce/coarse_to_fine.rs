//! The coarse-to-fine particle filter with bottom-up aggregation of body parts: one camera, 330 frames, against CONDENSATION with more than twice the particles.
//!
//! | file | what |
//! |---|---|
//! | [`scene`] | sequence, body, true poses, grid |
//! | [`contender`] | who is compared |
//! | [`condensation`] | the opponent |
//! | [`track`] | one run and what its estimates are worth |
//! | [`results`] | means, errors, paired differences |
//! | [`claims`] | the paper's claims and what became of them |
//! | [`tables`], [`figures`] | numbers as files, the figure |
//!
//! No setting was chosen on the test sequence: they are the paper's, or the specification's where the paper is silent.

mod claims;
mod condensation;
mod contender;
mod figures;
mod results;
mod scene;
mod tables;
mod track;

use crate::store::{Store, Task, run_all};
use contender::{Contender, Person};
use results::Results;
use scene::{FRAMES, Scene};
use sinew::core::lanes::Isa;
use sinew::files::FNV_START;
use sinew::synthetic::segmentation_noise::Level;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;
use track::Seen;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// The part A of the last change of the estimate by which particles move on (eq. 2).
const DRIFT: f64 = 0.2;

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;

/// Reproduces the tables and the figure of the coarse-to-fine particle filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in a minute, which only checks the directions of CC1, CC2 and CC4, and CC6
    #[arg(long)]
    quick: bool,
    /// Seeds from 1 on, each another person, other noise and other particles
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Levels of noise, separated by commas; claims are judged on `normal`
    #[arg(long, value_delimiter = ',', default_value = "normal,clean,hard", value_parser = ["normal", "clean", "hard"])]
    levels: Vec<String>,
    /// Leave out what goes beyond the paper
    #[arg(long)]
    paper_only: bool,
    /// Folder for cells, tables and figures [default: target/reproduce/coarse-to-fine]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]; without it the synthetic sequence is used
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Images of a person, level and seed; drawn by the first cell that needs them.
type Drawn = Arc<OnceLock<Seen>>;

/// What all cells share.
struct Study {
    scene: Scene,
    isa: Isa,
    drawn: Mutex<BTreeMap<String, Drawn>>,
}

impl Study {
    fn configuration(&self) -> String {
        format!(
            "version {VERSION}, {}, {} frames, {:016x}",
            self.isa.name(),
            self.scene.truth.len(),
            self.scene.hash(FNV_START)
        )
    }

    fn seen(&self, person: Person, level: Level, seed: u64) -> Outcome<Drawn> {
        let name = format!("{person:?} {level:?} {seed}");
        let drawn = Arc::clone(self.drawn.lock().unwrap_or_else(PoisonError::into_inner).entry(name).or_default());
        if drawn.get().is_none() {
            let seen = Seen::new(&self.scene, person, level, seed, self.isa)?;
            // Another cell may have drawn the same in the meantime.
            let _ = drawn.set(seen);
        }
        Ok(drawn)
    }

    fn task(&self, level: Level, contender: Contender, seed: u64) -> Task<'_> {
        let run = move || {
            let drawn = self.seen(contender.person, level, seed)?;
            let seen = drawn.get().ok_or("images were not drawn")?;
            track::cell(&self.scene, seen, &contender, seed, self.isa)
        };
        (contender.key(level, seed), 100.0 + contender.evaluations() as f64, Box::new(run))
    }
}

/// Runs the contenders of a level for all seeds, one seed after the other.
fn run_level(
    study: &Study,
    store: &mut Store,
    level: Level,
    contenders: &[Contender],
    seeds: &[u64],
    threads: usize,
) -> Outcome<()> {
    let each = seeds.iter().flat_map(|&seed| contenders.iter().map(move |&contender| (contender, seed)));
    let tasks = each.map(|(contender, seed)| study.task(level, contender, seed)).collect();
    run_all(store, tables::level_name(level), tasks, threads)
}

/// Tables, figure and claims into the folder and onto the terminal.
fn report(study: &Study, results: &Results<'_>, runs: &[(Level, Vec<Contender>)], folder: &Path) -> Outcome<bool> {
    let mut text = String::new();
    for (level, contenders) in runs {
        text.push_str(&format!(
            "## {}\n\n{}\n{}\n{}\n",
            tables::level_name(*level),
            tables::levels(results, *level)?,
            tables::pairs(results, *level)?,
            tables::all(results, *level, contenders)?
        ));
    }
    std::fs::write(folder.join("tables.md"), &text)?;
    std::fs::write(folder.join("tables.csv"), tables::csv(results, runs)?)?;
    println!("{text}");
    let levels: Vec<Level> = runs.iter().map(|(level, _)| *level).collect();
    let judged = if levels.contains(&claims::LEVEL) { claims::judge(results, &study.scene)? } else { vec![] };
    let json = tables::json(results, &study.scene, &judged, &levels);
    std::fs::write(folder.join("results.json"), serde_json::to_string_pretty(&json)?)?;
    if !judged.is_empty() {
        figures::draw(results, &folder.join("likelihood.svg"))?;
        let table = super::claim::table(&judged);
        std::fs::write(folder.join("claims.md"), &table)?;
        println!("{table}");
    }
    let asserted = ["CC1", "CC2", "CC4", "CC6"];
    Ok(judged.iter().all(|claim| claim.direction || !asserted.contains(&claim.id)))
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let clock = Instant::now();
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data")).join("cmu_amc");
    let recordings = data.is_dir().then_some(data.as_path());
    if recordings.is_none() {
        println!("no recordings in {}: the synthetic sequence is used", data.display());
    }
    let name = if args.quick { "coarse-to-fine-quick" } else { "coarse-to-fine" };
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/reproduce").join(name));
    let frames = if args.quick { 24 } else { FRAMES };
    let study = Study { scene: Scene::new(recordings, frames)?, isa: Isa::best(), drawn: Mutex::default() };
    let mut store = Store::open(&folder, &study.configuration())?;
    let threads = args.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |n| n.get()));
    let seeds: Vec<u64> = (1..=if args.quick { 1 } else { args.seeds }).collect();
    let mut runs: Vec<(Level, Vec<Contender>)> = vec![];
    for name in args.levels.iter().take(if args.quick { 1 } else { usize::MAX }) {
        let level = Level::named(name).ok_or("no such level")?;
        let mut contenders = contender::main();
        run_level(&study, &mut store, level, &contenders, &seeds, threads)?;
        if level == claims::LEVEL && !args.quick && !args.paper_only {
            let beside = contender::beside();
            run_level(&study, &mut store, level, &beside, &seeds, threads)?;
            contenders.extend(beside);
        }
        study.drawn.lock().unwrap_or_else(PoisonError::into_inner).clear();
        runs.push((level, contenders));
    }
    let directions = report(&study, &Results { store: &store, seeds: &seeds }, &runs, &folder)?;
    if args.quick {
        println!(
            "reduced size: verdicts are those of the full run only; asserted are the directions of CC1, CC2 and CC4, and CC6"
        );
    }
    println!(
        "{}: {} frames, {} seeds; {:.0} s; cells, tables and the figure in {}",
        study.scene.name,
        study.scene.truth.len(),
        seeds.len(),
        clock.elapsed().as_secs_f64(),
        folder.display()
    );
    Ok(if args.quick && !directions { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole command in a reduced size: files are written, directions are the paper's, and coarse particles stand on their grid.
    #[test]
    fn the_reduced_study_holds() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let out = std::env::temp_dir().join(format!("sinew-coarse-to-fine-{}", std::process::id()));
        let args = Args {
            quick: true,
            seeds: 1,
            levels: vec!["normal".into()],
            paper_only: true,
            out: Some(out.clone()),
            threads: None,
            data: std::env::var_os("SINEW_DATA").map(PathBuf::from),
        };
        assert_eq!(run(root, &args).unwrap(), ExitCode::SUCCESS, "claims whose direction differs are printed above");
        for file in ["cells.jsonl", "tables.md", "tables.csv", "claims.md", "results.json", "likelihood.svg"] {
            assert!(out.join(file).is_file(), "{file}");
        }
        std::fs::remove_dir_all(&out).unwrap();
    }
}
