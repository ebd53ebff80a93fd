//! Choo & Fleet, "People tracking using hybrid Monte Carlo filtering", ICCV 2001: how much better are gradients than particles, and in how many dimensions?
//!
//! | file | what |
//! |---|---|
//! | [`scene`] | motion, camera, observed markers |
//! | [`problem`] | the posterior of a part of the body in one frame |
//! | [`importance`], [`chains`] | one frame of a particle filter, one frame of a hybrid Monte Carlo filter |
//! | [`single`], [`multi`] | the two studies |
//! | [`opponents`], [`cameras`] | beyond the paper: other samplers and a search; more cameras and other errors |
//! | [`store`] | finished cells on disk |
//! | [`curves`] | variance against cost, and ratios at equal variance |
//! | [`claims`] | the paper's claims and what became of them |
//! | [`tables`], [`figures`] | numbers as files, figures |
//!
//! Step sizes and lengths are tuned on the first frame of walking, before any result is seen, and stay.

mod cameras;
mod chains;
mod claims;
mod curves;
mod figures;
mod importance;
mod multi;
mod opponents;
mod problem;
mod scene;
mod single;
mod tables;

use crate::store::{self, Store, Task, run_all};
use chains::{Step, Variant};
use clap::ValueEnum;
use problem::{MODELS, Model, Problem};
use scene::{Motion, Source};
use serde_json::json;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::files::FNV_START;
use sinew::observe::ObservationModel as _;
use single::Setting;
use std::collections::BTreeMap;
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Parts of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Variance against computation in single frames.
    Single,
    /// Both filters over 25 frames.
    Multi,
    /// The dimension in which hmc overtakes particles.
    Crossover,
    /// Single frames against other samplers and annealed search.
    Opponents,
    /// 1, 2 and 4 cameras and three errors of the images.
    Cameras,
}

/// Reproduces the tables and figures of the hybrid Monte Carlo filter.
#[derive(clap::Args)]
pub(super) struct Args {
    /// A reduced size in a minute, which only checks the directions of CF1, CF2 and CF5
    #[arg(long)]
    quick: bool,
    /// Parts to run, separated by commas [default: all]
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Folder for cells, tables and figures [default: target/reproduce/choo-fleet]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Seed of all random streams
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder of the shared recordings [default: $SINEW_DATA, else shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Frames of the single-frame study: motion and number from 1 at 120 frames a second. The first one is for tuning.
const FRAMES: [(&str, usize); 6] =
    [("07_01", 60), ("07_01", 160), ("07_01", 260), ("131_04", 200), ("131_04", 500), ("131_04", 900)];

/// How much is run.
#[derive(Clone, Debug)]
pub(super) struct Size {
    /// Frames of [`FRAMES`].
    frames: Vec<usize>,
    /// Independent runs a cell.
    runs: usize,
    /// Doublings of the settings of Table 1.
    doublings: Vec<u32>,
    /// Parts of the reference of 4-D and 10-D.
    reference_parts: usize,
    /// Updates of the reference of 28-D.
    reference_updates: usize,
    variants: Vec<Variant>,
    sources: Vec<Source>,
    /// Noise draws of the multi-frame study.
    noises: usize,
}

impl Size {
    fn full() -> Self {
        Self {
            frames: (0..6).collect(),
            runs: 50,
            doublings: (0..7).collect(),
            reference_parts: 50,
            reference_updates: 20_000,
            variants: Variant::ALL.to_vec(),
            sources: vec![Source::Recorded, Source::Fitted],
            noises: 50,
        }
    }

    fn quick() -> Self {
        Self {
            frames: vec![0, 4],
            runs: 20,
            doublings: vec![0, 2],
            reference_parts: 10,
            reference_updates: 500,
            variants: vec![Variant::Paper],
            sources: vec![Source::Recorded],
            noises: 0,
        }
    }
}

/// Everything that cells need.
struct Study {
    isa: Isa,
    seed: u64,
    size: Size,
    motions: BTreeMap<&'static str, Motion>,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 3;

impl Study {
    /// Everything that the numbers of a cell depend on, the motion included.
    fn configuration(&self) -> String {
        let motion = self.motions.values().fold(FNV_START, |hash, motion| motion.hash(hash));
        format!(
            "version {VERSION}, {}, seed {}, {:?}, {:?}, {MODELS:?}, {:?}, {MULTI:?}, {MULTI_UPDATES}, {MULTI_FRAMES}, {motion:016x}",
            self.isa.name(),
            self.seed,
            self.size,
            FRAMES,
            problem::nested(),
        )
    }

    /// The problem of a frame; its observation is fixed by the seed.
    fn problem(&self, source: Source, frame: usize, model: Model) -> Outcome<Problem> {
        let (name, number) = FRAMES[frame];
        let motion = &self.motions[name];
        let camera = motion.camera(number, self.isa);
        let found = motion.frame(number, source)?;
        let stage = Stage::new(self.seed, "choo-fleet observation").at_frame(frame as u32);
        let seen = scene::seen(&camera, &found.markers, stage);
        Problem::new(model, &found, Box::new(camera.bind(&seen)), self.isa)
    }

    fn settings(&self, model: &Model) -> Vec<Setting> {
        let doubled = |base: usize| self.size.doublings.iter().map(move |&k| base << k);
        let updates = |&variant| doubled(8).map(move |updates| Setting::Updates(variant, updates));
        let wanted = |variant: &&Variant| model.is_of_paper() || **variant != Variant::Paper;
        let chains = self.size.variants.iter().filter(wanted).flat_map(updates);
        doubled(model.particles).map(Setting::Particles).chain(chains).collect()
    }
}

/// Name of a frame for tables.
fn frame_name(frame: usize) -> String {
    let (name, number) = FRAMES[frame];
    format!("{} {number}", if name == "07_01" { "walking" } else { "dancing" })
}

fn tuning_key(model: &Model, variant: Variant) -> String {
    format!("tuning/{}/{}", model.name(), variant.name())
}

fn cell_key(source: Source, frame: usize, model: &Model, setting: &Setting) -> String {
    format!("single/{}/{}/{}/{}", source.name(), frame_name(frame), model.name(), setting.name())
}

fn factor_key(model: &Model) -> String {
    format!("factor/{}", model.name())
}

fn reference_key(source: Source, frame: usize, model: &Model) -> String {
    format!("reference/{}/{}/{}", source.name(), frame_name(frame), model.name())
}

fn step_of(store: &Store, model: &Model, variant: Variant) -> Outcome<Step> {
    let value = store.get(&tuning_key(model, variant)).ok_or("a step was not tuned")?;
    let number = |name: &str| value[name].as_f64().ok_or("a step was not stored");
    Ok(Step { eta: number("eta")?, steps: number("steps")? as usize, acceptance: number("acceptance")? })
}

fn tune(study: &Study, store: &mut Store, models: &[Model], threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for &model in models {
        tasks.push((
            factor_key(&model),
            1.0,
            Box::new(move || Ok(json!(study.problem(Source::Recorded, 0, model)?.gradient_factor()))),
        ));
        // The long runs of the reference use the dense metric whatever is compared.
        for variant in Variant::ALL {
            let task = move || {
                let problem = study.problem(Source::Recorded, 0, model)?;
                let stage = Stage::new(study.seed, "choo-fleet tuning").split([variant.name()]);
                let [stage] = stage;
                let step = chains::tune(&problem, variant, stage)?;
                Ok(json!({ "eta": step.eta, "steps": step.steps, "acceptance": step.acceptance }))
            };
            tasks.push((tuning_key(&model, variant), 10.0, Box::new(task)));
        }
    }
    // Times are taken alone.
    let factors = tasks.extract_if(.., |(key, ..)| key.starts_with("factor")).collect();
    run_all(store, "gradient factors", factors, 1)?;
    run_all(store, "tuning", tasks, threads)
}

/// Which single frames of which parts of the body.
struct Frames<'a> {
    name: &'a str,
    models: &'a [Model],
    sources: &'a [Source],
    frames: &'a [usize],
    /// Updates of the references by long chains.
    reference_updates: usize,
}

/// References, then all settings.
fn single_frames(study: &Study, store: &mut Store, what: &Frames<'_>, threads: usize) -> Outcome<()> {
    let mut references: Vec<Task<'_>> = vec![];
    let mut cells: Vec<Task<'_>> = vec![];
    let Size { runs, reference_parts, .. } = study.size;
    let reference_updates = what.reference_updates;
    for &source in what.sources {
        for &frame in what.frames {
            for &model in what.models {
                let dense = step_of(store, &model, Variant::Dense)?;
                let most = model.particles << study.size.doublings.last().copied().unwrap_or(0);
                let work = if model.dim <= single::WEIGHABLE {
                    most * reference_parts
                } else {
                    64 * 2 * reference_updates * dense.steps
                };
                let reference = move || {
                    let stage = Stage::new(study.seed, "choo-fleet reference").at_frame(frame as u32);
                    let problem = study.problem(source, frame, model)?;
                    single::reference(&problem, most, reference_parts, reference_updates, &dense, stage)
                };
                references.push((reference_key(source, frame, &model), work as f64, Box::new(reference)));
                for setting in study.settings(&model) {
                    let step = match setting {
                        Setting::Updates(variant, _) => Some(step_of(store, &model, variant)?),
                        Setting::Particles(_) => None,
                    };
                    let work = match (setting, &step) {
                        (Setting::Particles(count), _) => count,
                        (Setting::Updates(_, updates), Some(step)) => 2 * 16 * updates * step.steps,
                        _ => 0,
                    };
                    let cell = move || {
                        let stage = Stage::new(study.seed, "choo-fleet single").at_frame(frame as u32);
                        let [stage] = stage.split([setting.name().as_str()]);
                        single::cell(&study.problem(source, frame, model)?, setting, step.as_ref(), runs, &stage)
                    };
                    cells.push((cell_key(source, frame, &model, &setting), (work * runs) as f64, Box::new(cell)));
                }
            }
        }
    }
    run_all(store, &format!("references of {}", what.name), references, threads)?;
    run_all(store, what.name, cells, threads)
}

/// Frames of walking, for the crossover.
const CROSSOVER_FRAMES: [usize; 3] = [0, 1, 2];

/// Models and particle numbers of the multi-frame study, at the cost of R = 32.
const MULTI: [(usize, usize); 2] = [(1, 23_000), (2, 108_000)];
/// Updates there.
const MULTI_UPDATES: usize = 32;
/// Frames there.
const MULTI_FRAMES: usize = 25;

fn multi_key(source: Source, model: &Model, filter: &multi::Filter, noise: usize) -> String {
    format!("multi/{}/{}/{}/{noise}", source.name(), model.dim, filter.name())
}

/// The two filters of a model in the multi-frame study.
fn filters(store: &Store, index: usize) -> Outcome<(Model, [multi::Filter; 2])> {
    let (model, particles) = MULTI[index];
    let model = MODELS[model];
    let step = step_of(store, &model, Variant::Paper)?;
    Ok((model, [multi::Filter::Hmc(MULTI_UPDATES, step), multi::Filter::Particles(particles)]))
}

fn multi_frames(study: &Study, store: &mut Store, threads: usize) -> Outcome<()> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for index in 0..MULTI.len() {
        let (model, both) = filters(store, index)?;
        let each = study.size.sources.iter().flat_map(|&source| both.map(|filter| (source, filter)));
        for (source, filter) in each {
            for noise in 0..study.size.noises {
                let seed = study.seed.wrapping_mul(1000).wrapping_add(noise as u64) as usize;
                let task = move || {
                    let motion = &study.motions["07_01"];
                    multi::run(motion, source, &model, &filter, MULTI_FRAMES, seed, study.isa)
                };
                tasks.push((multi_key(source, &model, &filter, noise), model.particles as f64, Box::new(task)));
            }
        }
    }
    run_all(store, "frames in a row", tasks, threads)
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    if !data.join("cmu_amc").is_dir() {
        println!("skipped: no data in {}", data.display());
        return Ok(ExitCode::SUCCESS);
    }
    let clock = Instant::now();
    let size = if args.quick { Size::quick() } else { Size::full() };
    let folder = args.out.clone().unwrap_or_else(|| {
        root.join("target/reproduce").join(if args.quick { "choo-fleet-quick" } else { "choo-fleet" })
    });
    let mut motions = BTreeMap::new();
    for name in ["07_01", "131_04"] {
        motions.insert(name, scene::motion(&data, name)?);
    }
    let study = Study { isa: Isa::best(), seed: args.seed, size, motions };
    let configuration = study.configuration();
    let mut store = Store::open(&folder, &configuration)?;
    let granted = std::thread::available_parallelism().map_or(1, |n| n.get());
    let threads = args.threads.unwrap_or(granted);
    let wanted = |part| args.only.is_empty() || args.only.contains(&part);
    tune(&study, &mut store, &MODELS, threads)?;
    if wanted(Part::Single) {
        let what = Frames {
            name: "single frames",
            models: &MODELS,
            sources: &study.size.sources,
            frames: &study.size.frames,
            reference_updates: study.size.reference_updates,
        };
        single_frames(&study, &mut store, &what, threads)?;
    }
    let nested = problem::nested();
    let with_crossover = wanted(Part::Crossover) && !args.quick;
    if with_crossover {
        tune(&study, &mut store, &nested, threads)?;
        let what = Frames {
            name: "crossover",
            models: &nested,
            sources: &[Source::Recorded],
            frames: &CROSSOVER_FRAMES,
            reference_updates: study.size.reference_updates / 4,
        };
        single_frames(&study, &mut store, &what, threads)?;
    }
    if wanted(Part::Multi) && study.size.noises > 0 {
        multi_frames(&study, &mut store, threads)?;
    }
    let mut beyond = serde_json::Map::new();
    if wanted(Part::Opponents) && !args.quick {
        let what = Frames {
            name: "single frames",
            models: &MODELS,
            sources: &[Source::Recorded],
            frames: &study.size.frames,
            reference_updates: study.size.reference_updates,
        };
        single_frames(&study, &mut store, &what, threads)?;
        beyond.insert("opponents".into(), opponents::run(&study, &store, (&folder, &configuration), threads)?);
    }
    if wanted(Part::Cameras) && !args.quick {
        beyond.insert("cameras".into(), cameras::run(&study, (&folder, &configuration), threads)?);
    }
    let judged = claims::judge(&study, &store, wanted(Part::Single), wanted(Part::Multi) && study.size.noises > 0)?;
    tables::write(&study, &store, &judged, &beyond, &folder)?;
    figures::draw(&study, &store, &folder)?;
    println!("{}", super::claim::table(&judged));
    if args.quick {
        println!(
            "reduced size: verdicts are those of the full run only; asserted are the directions of CF1, CF2 and CF5"
        );
    }
    if with_crossover {
        let found = claims::crossover(&study, &store, &nested, &CROSSOVER_FRAMES)?;
        std::fs::write(folder.join("crossover.csv"), tables::crossover(&found))?;
        figures::crossover(&found, &folder.join("crossover.svg"))?;
        println!("{}", tables::crossover(&found));
    }
    println!("{:.0} s; cells, tables and figures in {}", clock.elapsed().as_secs_f64(), folder.display());
    let directions = ["CF1", "CF2", "CF5"];
    let failed = args.quick && judged.iter().any(|claim| directions.contains(&claim.id) && !claim.direction);
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The whole command in a reduced size: files are written, and the directions of CF1, CF2 and CF5 are the paper's.
    #[test]
    fn the_reduced_study_holds() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
        let out = std::env::temp_dir().join(format!("sinew-reproduction-{}", std::process::id()));
        if sinew_tests::data::shared("cmu_amc").is_none() {
            return;
        }
        let data = Some(sinew_tests::data::folder());
        let args = Args { quick: true, only: vec![], out: Some(out.clone()), seed: 1, threads: None, data };
        assert_eq!(run(root, &args).unwrap(), ExitCode::SUCCESS, "claims that fail are printed above");
        assert!(out.join("cells.jsonl").is_file() && std::fs::read_dir(&out).unwrap().count() > 3);
        std::fs::remove_dir_all(&out).unwrap();
    }
}
