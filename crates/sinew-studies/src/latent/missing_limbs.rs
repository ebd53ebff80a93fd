//! `cargo xtask study missing-limbs`: which model fills in the missing limbs of subject 35, the tables of docs/evidence/latent.md.
//!
//! 1. Pilot: every contender fills in the later half of training sequences that were left out of its training ([`pilot::FOLDS`])
//! 2. Choice: the latent model whose errors, each over that of nearest neighbours (scaled) on the same sequence and limb, have the least mean
//! 3. The chosen model learns from all training sequences and fills in the test sequence, once
//!
//! What is computed stands in `sinew_tests::missing_limbs`; [`contenders`] lists who takes part, [`tables`] writes what was found.

mod contenders;
mod pilot;
mod tables;

use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use crate::support::study_options::StudyOptions;
use contenders::{Contender, LATENT, Latent, REFERENCES};
use pilot::{FOLDS, LIMBS, Pilot, Score, key};
use serde_json::{Value, json};
use sinew::core::lanes::Isa;
use sinew_tests::missing_limbs::latent::{self, Learned};
use sinew_tests::missing_limbs::task::Task as Limb;
use sinew_tests::missing_limbs::{Benchmark, LEG};
use std::ops::Range;
use std::path::Path;

/// Fills in missing limbs, first of training sequences, then of the test sequence.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    options: StudyOptions,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;

fn reference_cell(benchmark: &Benchmark, fold: &[usize], contender: Contender) -> Outcome<Value> {
    let score = |one: usize, limb: &Range<usize>| -> Outcome<Value> {
        let task = benchmark.left_out(fold, one, limb);
        let found = benchmark.judged(&task, &contender.fill(&task)?);
        Ok(Score { cumulative: found.cumulative, rms_deg: found.rms_deg, covered: vec![] }.to_json())
    };
    let both = |&one: &usize| LIMBS.iter().map(|(_, limb)| score(one, limb)).collect::<Outcome<Vec<_>>>();
    Ok(json!(fold.iter().map(both).collect::<Outcome<Vec<_>>>()?))
}

fn latent_score(benchmark: &Benchmark, learned: &Learned, task: &Limb<'_>, rows: latent::Rows) -> Outcome<Score> {
    let said = learned.fill(task, rows)?;
    let found = benchmark.judged(task, &latent::means(&said));
    let covered = latent::covered(task, &said).to_vec();
    Ok(Score { cumulative: found.cumulative, rms_deg: found.rms_deg, covered })
}

/// One model of a fold with all its ways to find latents: scores by way, sequence and limb.
fn model_cell(benchmark: &Benchmark, fold: &[usize], model: &Latent) -> Outcome<Value> {
    let training = benchmark.left_out(fold, fold[0], &LEG).training;
    let learned = latent::learn(&training, &model.config)?;
    let score = |one: usize, limb: &Range<usize>, rows: latent::Rows| -> Outcome<Value> {
        Ok(latent_score(benchmark, &learned, &benchmark.left_out(fold, one, limb), rows)?.to_json())
    };
    let both = |one: usize, rows| LIMBS.iter().map(|(_, limb)| score(one, limb, rows)).collect::<Outcome<Vec<_>>>();
    let way = |&rows: &latent::Rows| fold.iter().map(|&one| both(one, rows)).collect::<Outcome<Vec<_>>>();
    Ok(json!(model.ways.iter().map(way).collect::<Outcome<Vec<_>>>()?))
}

fn tasks(benchmark: &Benchmark) -> Vec<Task<'_>> {
    let mut tasks: Vec<Task<'_>> = vec![];
    for (f, fold) in FOLDS.iter().enumerate() {
        for contender in REFERENCES {
            tasks.push((key(f, contender.name()), 1.0, Box::new(move || reference_cell(benchmark, fold, contender))));
        }
        for model in &LATENT {
            tasks.push((key(f, model.name), model.work(), Box::new(move || model_cell(benchmark, fold, model))));
        }
    }
    tasks
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let data = args.options.data(root);
    let benchmark = Benchmark::read(&data.join("mocap35_missing"))?;
    let folder = args.options.folder(root, "missing-limbs")?;
    let mut store = Store::open(&folder, &format!("version {VERSION}, {}, {FOLDS:?}", Isa::best().name()))?;
    run_all(&mut store, "missing limbs", tasks(&benchmark), args.options.threads())?;
    let pilot = Pilot::read(&store);
    let (model, rows) = pilot.chosen()?;
    let mut text = tables::pilot(&pilot);
    let name = format!("test/{}/{rows:?}", model.name);
    let last = || -> Outcome<Value> {
        let learned = latent::learn(&benchmark.published(&LEG).training, &model.config)?;
        let of = |(_, limb): &(&str, Range<usize>)| {
            Ok(latent_score(&benchmark, &learned, &benchmark.published(limb), rows)?.to_json())
        };
        Ok(json!(LIMBS.iter().map(of).collect::<Outcome<Vec<_>>>()?))
    };
    run_all(&mut store, "test sequence", vec![(name.clone(), 1.0, Box::new(last))], 1)?;
    let found = store.get(&name).cloned().unwrap_or_default();
    text += &tables::test(model, rows, &[0, 1].map(|k| Score::from_json(&found[k])));
    std::fs::write(folder.join("tables.md"), &text)?;
    println!("{text}");
    Ok(())
}
