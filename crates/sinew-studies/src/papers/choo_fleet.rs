//! How much better are gradients than particles, and in how many dimensions?
//!
//! Choo & Fleet, "People tracking using hybrid Monte Carlo filtering", ICCV 2001.
//!
//! | file | what |
//! |---|---|
//! | [`scene`] | motion, camera, observed markers |
//! | [`problem`] | the posterior of a part of the body in one frame |
//! | [`chains`] | one frame of a hybrid Monte Carlo filter; that of a particle filter is [`likelihood_weighting`] |
//! | [`single`], [`multi`] | the two studies |
//! | [`opponents`], [`cameras`] | beyond the paper: other samplers and a search; more cameras and other errors |
//! | [`study`], [`cells`] | how much is run, and what |
//! | [`curves`], [`crossover`] | variance against cost, and ratios at equal variance; where chains overtake particles |
//! | [`claims`] | the paper's claims and what became of them, by [`single_claims`] and [`multi_claims`] |
//! | [`tables`], [`figures`] | numbers as files, figures |
//!
//! Step sizes and lengths are tuned on the first frame of walking, before any result is seen, and stay.

mod cameras;
mod cells;
mod chains;
mod claims;
mod crossover;
mod curves;
mod figures;
mod likelihood_weighting;
mod multi;
mod multi_claims;
mod opponents;
mod problem;
mod scene;
mod single;
mod single_claims;
mod study;
mod summary;
mod tables;

use crate::support::outcome::Outcome;
use crate::support::store::Store;
use crate::support::study_options::StudyOptions;
use clap::ValueEnum;
use problem::MODELS;
use scene::Source;
use serde_json::{Map, Value};
use sinew::core::lanes::Isa;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use study::{Size, Study};

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
    /// Seed of all random streams
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    options: StudyOptions,
}

/// Frames of walking, for the crossover.
const CROSSOVER_FRAMES: [usize; 3] = [0, 1, 2];

/// A command that is running.
struct Run<'a> {
    args: &'a Args,
    study: Study,
    folder: PathBuf,
    configuration: String,
    threads: usize,
}

impl Run<'_> {
    fn wanted(&self, part: Part) -> bool {
        self.args.only.is_empty() || self.args.only.contains(&part)
    }

    /// Whether a part is wanted that only the full size has.
    fn wanted_in_full(&self, part: Part) -> bool {
        self.wanted(part) && !self.args.quick
    }

    fn has_frames_in_a_row(&self) -> bool {
        self.wanted(Part::Multi) && self.study.size.noises > 0
    }

    /// All cells of the paper's own parts, and of the crossover.
    fn cells(&self, store: &mut Store) -> Outcome<()> {
        let (study, threads) = (&self.study, self.threads);
        cells::tune(study, store, &MODELS, threads)?;
        if self.wanted(Part::Single) {
            cells::single_frames(study, store, &self.single_frames(&study.size.sources), threads)?;
        }
        if self.wanted_in_full(Part::Crossover) {
            let nested = problem::nested();
            cells::tune(study, store, &nested, threads)?;
            let what = cells::Frames {
                name: "crossover",
                models: &nested,
                sources: &[Source::Recorded],
                frames: &CROSSOVER_FRAMES,
                reference_updates: study.size.reference_updates / 4,
            };
            cells::single_frames(study, store, &what, threads)?;
        }
        if self.has_frames_in_a_row() {
            cells::multi_frames(study, store, threads)?;
        }
        Ok(())
    }

    fn single_frames<'a>(&'a self, sources: &'a [Source]) -> cells::Frames<'a> {
        cells::Frames {
            name: "single frames",
            models: &MODELS,
            sources,
            frames: &self.study.size.frames,
            reference_updates: self.study.size.reference_updates,
        }
    }

    /// What goes beyond the paper, by the names of its parts.
    fn beyond(&self, store: &mut Store) -> Outcome<Map<String, Value>> {
        let (study, place) = (&self.study, (self.folder.as_path(), self.configuration.as_str()));
        let mut beyond = Map::new();
        if self.wanted_in_full(Part::Opponents) {
            cells::single_frames(study, store, &self.single_frames(&[Source::Recorded]), self.threads)?;
            beyond.insert("opponents".into(), opponents::run(study, store, place, self.threads)?);
        }
        if self.wanted_in_full(Part::Cameras) {
            beyond.insert("cameras".into(), cameras::run(study, place, self.threads)?);
        }
        Ok(beyond)
    }

    /// Judges, writes and draws what was run; returns whether a direction of the reduced size failed.
    fn report(&self, store: &Store, beyond: &Map<String, Value>) -> Outcome<bool> {
        let (study, folder) = (&self.study, &self.folder);
        let judged = claims::judge(study, store, self.wanted(Part::Single), self.has_frames_in_a_row())?;
        tables::write(study, store, &judged, beyond, folder)?;
        figures::draw(study, store, folder)?;
        println!("{}", super::claim::table(&judged));
        if self.args.quick {
            println!("reduced size: verdicts need the full run; asserted are the directions of CF1, CF2 and CF5");
        }
        if self.wanted_in_full(Part::Crossover) {
            let found = crossover::crossover(study, store, &problem::nested(), &CROSSOVER_FRAMES)?;
            std::fs::write(folder.join("crossover.csv"), tables::crossover(&found))?;
            figures::crossover(&found, &folder.join("crossover.svg"))?;
            println!("{}", tables::crossover(&found));
        }
        Ok(self.args.quick && self.wanted(Part::Single) && !single_claims::directions_hold(study, store)?)
    }
}

/// Runs the command.
pub(super) fn run(root: &Path, args: &Args) -> Outcome<ExitCode> {
    let data = args.options.recordings(root)?;
    let clock = Instant::now();
    let size = if args.quick { Size::quick() } else { Size::full() };
    let name = if args.quick { "reproduce/choo-fleet-quick" } else { "reproduce/choo-fleet" };
    let folder = args.options.folder(root, name)?;
    let mut motions = BTreeMap::new();
    for name in ["07_01", "131_04"] {
        motions.insert(name, scene::motion(&data, name)?);
    }
    let study = Study { isa: Isa::best(), seed: args.seed, size, motions };
    let configuration = study.configuration();
    let mut store = Store::open(&folder, &configuration)?;
    let run = Run { args, study, folder, configuration, threads: args.options.threads() };
    run.cells(&mut store)?;
    let beyond = run.beyond(&mut store)?;
    let failed = run.report(&store, &beyond)?;
    println!("{:.0} s; cells, tables and figures in {}", clock.elapsed().as_secs_f64(), run.folder.display());
    Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

#[cfg(test)]
mod tests {
    use crate::papers::reduced_size;

    /// The whole command in a reduced size: files are written, and the directions of CF1, CF2 and CF5 are the paper's.
    #[test]
    fn the_reduced_study_holds() {
        if sinew_tests::data::shared("cmu_amc").is_none() {
            return;
        }
        reduced_size::holds("choo-fleet", &["cells.jsonl", "results.json", "variances.svg"]);
    }
}
