//! `cargo xtask missing-limbs`: which model fills in the missing limbs of subject 35, the tables of docs/evidence/latent.md.
//!
//! 1. Pilot: every contender fills in the later half of training sequences that were left out of its training ([`FOLDS`])
//! 2. Choice: the latent model whose errors, each over that of nearest neighbours (scaled) on the same sequence and limb, have the least mean
//! 3. The chosen model learns from all training sequences and fills in the test sequence, once
//!
//! What is computed stands in `sinew_tests::missing_limbs`; [`contenders`] lists who takes part, [`tables`] writes what was found.

mod contenders;
mod tables;

use crate::outcome::Outcome;
use crate::store::{Store, Task, numbers, run_all};
use contenders::{Contender, LATENT, Latent, REFERENCES};
use serde_json::{Value, json};
use sinew::core::lanes::Isa;
use sinew_tests::missing_limbs::latent::{self, Learned};
use sinew_tests::missing_limbs::task::Task as Limb;
use sinew_tests::missing_limbs::{BODY, Benchmark, LEG};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Fills in missing limbs, first of training sequences, then of the test sequence.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// The pilot alone
    #[arg(long)]
    pilot: bool,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    /// Folder for cells and tables [default: target/missing-limbs]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Folder of the shared recordings [default: shared/data beside the workspace]
    #[arg(long, env = "SINEW_DATA")]
    data: Option<PathBuf>,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;

/// Training sequences that are left out together: three walks and a run each.
const FOLDS: [[usize; 4]; 2] = [[3, 9, 27, 18], [1, 13, 30, 22]];

/// The limbs.
const LIMBS: [(&str, Range<usize>); 2] = [("leg", LEG), ("body", BODY)];

/// How one contender did on one sequence and limb.
#[derive(Clone, Debug)]
struct Score {
    cumulative: f64,
    rms_deg: f64,
    /// Shares of the truth within intervals; none of a reference that gives no intervals.
    covered: Vec<f64>,
}

impl Score {
    fn to_json(&self) -> Value {
        json!([[self.cumulative, self.rms_deg], self.covered])
    }

    fn from_json(value: &Value) -> Self {
        let errors = numbers(&value[0]);
        let at = |k: usize| errors.get(k).copied().unwrap_or(f64::NAN);
        Self { cumulative: at(0), rms_deg: at(1), covered: numbers(&value[1]) }
    }
}

/// Scores of one contender by fold: sequences of the fold, and of each the limbs.
type Scores = Vec<Vec<[Score; 2]>>;

fn of_reference(benchmark: &Benchmark, fold: &[usize], contender: Contender) -> Outcome<Value> {
    let score = |one: usize, limb: &Range<usize>| -> Outcome<Value> {
        let task = benchmark.left_out(fold, one, limb);
        let found = benchmark.judged(&task, &contender.fill(&task)?);
        Ok(Score { cumulative: found.cumulative, rms_deg: found.rms_deg, covered: vec![] }.to_json())
    };
    let both = |&one: &usize| LIMBS.iter().map(|(_, limb)| score(one, limb)).collect::<Outcome<Vec<_>>>();
    Ok(json!(fold.iter().map(both).collect::<Outcome<Vec<_>>>()?))
}

fn of_latent(benchmark: &Benchmark, learned: &Learned, task: &Limb<'_>, rows: latent::Rows) -> Outcome<Score> {
    let said = learned.fill(task, rows)?;
    let found = benchmark.judged(task, &latent::means(&said));
    let covered = latent::covered(task, &said).to_vec();
    Ok(Score { cumulative: found.cumulative, rms_deg: found.rms_deg, covered })
}

/// One model of a fold with all its ways to find latents: scores by way, sequence and limb.
fn of_model(benchmark: &Benchmark, fold: &[usize], model: &Latent) -> Outcome<Value> {
    let training = benchmark.left_out(fold, fold[0], &LEG).training;
    let learned = latent::learn(&training, &model.config)?;
    let score = |one: usize, limb: &Range<usize>, rows: latent::Rows| -> Outcome<Value> {
        Ok(of_latent(benchmark, &learned, &benchmark.left_out(fold, one, limb), rows)?.to_json())
    };
    let both = |one: usize, rows| LIMBS.iter().map(|(_, limb)| score(one, limb, rows)).collect::<Outcome<Vec<_>>>();
    let way = |&rows: &latent::Rows| fold.iter().map(|&one| both(one, rows)).collect::<Outcome<Vec<_>>>();
    Ok(json!(model.ways.iter().map(way).collect::<Outcome<Vec<_>>>()?))
}

fn key(fold: usize, name: &str) -> String {
    format!("{fold}/{name}")
}

fn tasks(benchmark: &Benchmark) -> Vec<Task<'_>> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for (f, fold) in FOLDS.iter().enumerate() {
        for contender in REFERENCES {
            tasks.push((key(f, contender.name()), 1.0, Box::new(move || of_reference(benchmark, fold, contender))));
        }
        for model in &LATENT {
            tasks.push((key(f, model.name), model.work(), Box::new(move || of_model(benchmark, fold, model))));
        }
    }
    tasks
}

fn scores(value: &Value) -> Vec<[Score; 2]> {
    let sequences = value.as_array().into_iter().flatten();
    sequences.map(|limbs| [0, 1].map(|k| Score::from_json(&limbs[k]))).collect()
}

/// Names of all contenders with their scores, references first; those of latent models with their place.
struct Pilot {
    references: Vec<(&'static str, Scores)>,
    latent: Vec<(&'static Latent, latent::Rows, Scores)>,
}

impl Pilot {
    fn read(store: &Store) -> Self {
        let of = |name: &str, within: &dyn Fn(&Value) -> Value| -> Scores {
            let cells = (0..FOLDS.len()).filter_map(|f| store.get(&key(f, name)));
            cells.map(|cell| scores(&within(cell))).collect()
        };
        let references = REFERENCES.iter().map(|c| (c.name(), of(c.name(), &Value::clone))).collect();
        let ways = LATENT.iter().flat_map(|model| model.ways.iter().enumerate().map(move |way| (model, way)));
        let latent = ways.map(|(model, (k, &rows))| (model, rows, of(model.name, &|cell| cell[k].clone()))).collect();
        Self { references, latent }
    }

    /// Mean over sequences and limbs of errors over those of scaled nearest neighbours.
    fn ratio(&self, scores: &Scores) -> f64 {
        let neighbours = &self.references[1].1;
        let pairs = scores.iter().flatten().flatten().zip(neighbours.iter().flatten().flatten());
        let ratios: Vec<f64> = pairs.map(|(own, near)| own.rms_deg / near.rms_deg).collect();
        ratios.iter().sum::<f64>() / ratios.len() as f64
    }

    /// The latent model with the least ratio.
    fn chosen(&self) -> Outcome<(&'static Latent, latent::Rows)> {
        let better = |a: &&(&Latent, latent::Rows, Scores), b: &&(&Latent, latent::Rows, Scores)| {
            self.ratio(&a.2).total_cmp(&self.ratio(&b.2))
        };
        let chosen = self.latent.iter().min_by(better).ok_or("no latent model")?;
        Ok((chosen.0, chosen.1))
    }
}

fn measure(root: &Path, args: &Args) -> Outcome<()> {
    let data = args.data.clone().unwrap_or_else(|| root.join("../shared/data"));
    let benchmark = Benchmark::read(&data.join("mocap35_missing"))?;
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/missing-limbs"));
    let mut store = Store::open(&folder, &format!("version {VERSION}, {}, {FOLDS:?}", Isa::best().name()))?;
    let granted = std::thread::available_parallelism().map_or(1, |n| n.get());
    run_all(&mut store, "missing limbs", tasks(&benchmark), args.threads.unwrap_or(granted))?;
    let pilot = Pilot::read(&store);
    let (model, rows) = pilot.chosen()?;
    let mut text = tables::pilot(&pilot);
    if !args.pilot {
        let name = format!("test/{}/{rows:?}", model.name);
        let last = || -> Outcome<Value> {
            let learned = latent::learn(&benchmark.published(&LEG).training, &model.config)?;
            let of = |(_, limb): &(&str, Range<usize>)| {
                Ok(of_latent(&benchmark, &learned, &benchmark.published(limb), rows)?.to_json())
            };
            Ok(json!(LIMBS.iter().map(of).collect::<Outcome<Vec<_>>>()?))
        };
        run_all(&mut store, "test sequence", vec![(name.clone(), 1.0, Box::new(last))], 1)?;
        let found = store.get(&name).cloned().unwrap_or_default();
        text += &tables::test(model, rows, &[0, 1].map(|k| Score::from_json(&found[k])));
    }
    std::fs::write(folder.join("tables.md"), &text)?;
    println!("{text}");
    Ok(())
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> ExitCode {
    match measure(root, args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
