//! `cargo xtask study motion-prior`: what a learned motion model is worth as the prior of the HMC filter on keypoints.
//!
//! It writes the tables of docs/evidence/experiments/motion-prior.md.
//!
//! | file | what |
//! |---|---|
//! | [`people`] | who walks, and the model that was learned from others |
//! | [`scene`] | one series: film, set-up, track |
//! | [`tables`] | means, and the judgement by criteria |
//!
//! Contenders of one walk and seed see the same keypoints, so that their errors are compared pair by pair.

mod people;
mod scene;
mod tables;

use crate::support::outcome::Outcome;
use crate::support::store::{Store, Task, run_all};
use crate::support::study_options::StudyOptions;
use people::{Models, PILOT, Person, TEST, UNSEEN};
use scene::{CONTENDERS, Contender, SCENES, Scene, Series};
use sinew::config::settings::Settings;
use sinew::core::lanes::Isa;
use std::path::Path;

/// Measures what a learned motion model is worth as a prior on keypoints.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Two walks and two seeds
    #[arg(long)]
    quick: bool,
    /// A walk of training instead, which the model does not learn from
    #[arg(long)]
    pilot: bool,
    /// People and motions that training lacks
    #[arg(long, conflicts_with = "pilot")]
    unseen: bool,
    /// Seeds from 1 on, each another noise and other chains
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Seeds of the learned mixture at most, whose cells cost many times as much
    #[arg(long, default_value_t = 2)]
    mixture_seeds: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 2;

/// What is run.
struct Study {
    models: Models,
    people: Vec<Person>,
    seeds: u64,
    /// Seeds of the learned mixture.
    mixture_seeds: u64,
}

fn key(scene: Scene, contender: Contender, person: &Person, seed: u64) -> String {
    format!("{}/{}/{}/{seed}", scene.name(), contender.name(), person.trial)
}

impl Study {
    /// Pairs of a person and a seed of a contender, seed after seed.
    fn pairs(&self, contender: Contender) -> impl Iterator<Item = (&Person, u64)> {
        let seeds = if contender.is_mixture_of_draws() { self.mixture_seeds } else { self.seeds };
        (1..=seeds).flat_map(|seed| self.people.iter().map(move |person| (person, seed)))
    }

    fn tasks(&self) -> Vec<Task<'_>> {
        let mut tasks: Vec<Task<'_>> = vec![];
        for contender in CONTENDERS {
            // A component for every draw costs many times as much as a few or one.
            let work = if contender.is_mixture_of_draws() { 10.0 } else { 1.0 };
            for (person, seed) in self.pairs(contender) {
                for scene in SCENES {
                    let run = move || Ok(scene::series(person, &self.models, scene, contender, seed)?.to_json());
                    tasks.push((key(scene, contender, person, seed), work * person.states.len() as f64, Box::new(run)));
                }
            }
        }
        tasks
    }

    fn found(&self, store: &Store, scene: Scene, contender: Contender) -> Vec<Series> {
        let cells = self.pairs(contender).filter_map(|(person, seed)| store.get(&key(scene, contender, person, seed)));
        cells.map(Series::from_json).collect()
    }
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let data = args.options.data(root);
    let (name, trials) = match args {
        Args { pilot: true, .. } => ("motion-prior-pilot", &PILOT[..]),
        Args { unseen: true, .. } => ("motion-prior-unseen", &UNSEEN[..]),
        Args { quick: true, .. } => ("motion-prior-quick", &TEST[..2]),
        _ => ("motion-prior", &TEST[..]),
    };
    let folder = args.options.folder(root, name)?;
    let without = if args.pilot { &PILOT[..] } else { &[] };
    let models = Models::new(&folder, &data, without)?;
    let people = trials.iter().map(|&trial| Person::new(&data, trial)).collect::<Outcome<Vec<_>>>()?;
    let seeds = if args.quick { args.seeds.min(2) } else { args.seeds };
    let configuration = format!("version {VERSION}, {}, {without:?}, {:?}", Isa::best().name(), Settings::default());
    let study = Study { models, people, seeds, mixture_seeds: seeds.min(args.mixture_seeds) };
    let mut store = Store::open(&folder, &configuration)?;
    run_all(&mut store, "motion prior", study.tasks(), args.options.threads())?;
    let found = |scene: Scene, contender: Contender| study.found(&store, scene, contender);
    let text = format!("{}\n{}", tables::measured(&found), tables::judged(&found));
    std::fs::write(folder.join("tables.md"), &text)?;
    println!("{text}");
    Ok(())
}
