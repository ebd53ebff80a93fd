//! `cargo xtask study intervals`: what intervals are worth where users stand, the tables of docs/evidence/intervals.md and angles.md.
//!
//! Everything goes through the program as a user runs it: `demo`, `track` and `predict`. What is predicted is held against keypoints by this study's own code.
//!
//! The bounds of [`protocol`] were fixed before the first run; docs/evidence/intervals.md says what was tuned, and on what.
//!
//! | file | what |
//! |---|---|
//! | [`demos`] | demos of many seeds: coverage of true coordinates, in all and within a run |
//! | [`caliscope`] | a recording that no tuning has touched, in the program's files |
//! | [`mod@left_out`] | cameras that a run did not use, predicted |
//! | [`pairs`] | runs of disjoint pairs of cameras, against each other |
//! | [`rigs`] | rigs drawn from the prior: ranks of what lasts, of poses, of a left-out camera's offset |
//! | [`straight`] | draws answer in a straight line: against runs that take their own constants for true |
//! | [`triangulation`] | points that another program triangulated |
//! | [`angles`] | angles of joints and their rates in `angles.csv` of demos |
//! | [`standing`] | the zero of angles from a standing trial |
//! | [`derived`] | angles, lengths, distances and displacements of demos |
//! | [`scores`] | log scores of left-out cameras, now and before |
//! | [`reliability`] | held against stated shares at many levels |
//! | [`before`] | runs without what lasts |
//! | [`posterior`], [`summary`] | draws of a run; means and ranks |
//! | [`protocol`] | what is run, and the bounds |

mod angles;
mod before;
mod caliscope;
mod demos;
mod derived;
mod left_out;
mod pairs;
mod posterior;
mod protocol;
mod reliability;
mod rigs;
mod scores;
mod standing;
mod straight;
mod summary;
mod triangulation;

pub(crate) use angles::true_angles;

use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::store::{Store, Task, run_all};
use crate::support::study_options::{ProgramOptions, threads};
use clap::ValueEnum;
use protocol::{FIRST_ANGLES, FIRST_DERIVED, FIRST_RIG, FIRST_RUN, FIRST_SEED, Recording, tuned_on};
use serde_json::Value;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Parts of the study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Coverage and common shift of demos.
    Demos,
    /// Cameras that a run did not use.
    LeftOut,
    /// Disjoint pairs of cameras.
    Pairs,
    /// Rigs drawn from the prior.
    Rigs,
    /// Rigs whose keypoints lie at the joints, as in demos.
    AtJoints,
    /// Two neighbouring cameras of rigs predict the others.
    RigPairs,
    /// Draws that answer in a straight line, against runs that take their own constants for true.
    Straight,
    /// Points that another program triangulated.
    Triangulation,
    /// What follows from draws of demos, and demos as they were before.
    Derived,
    /// Angles of joints and their rates, of demos.
    Angles,
    /// The zero of angles from a standing trial.
    Standing,
    /// Log scores of left-out cameras, now and before.
    Scores,
    /// Cameras that a run did not use, of the recording that no tuning has touched.
    Caliscope,
}

/// Judges intervals by cameras that are left out, by demos and by rigs that are drawn from the prior.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Demos, with seeds from 101 on
    #[arg(long, default_value_t = 400)]
    seeds: u64,
    /// Rigs drawn from the prior, with seeds from 1 on; as many again show what is chance
    #[arg(long, default_value_t = 200)]
    rigs: u64,
    /// Runs of each set of cameras of a recording, with seeds from 1 on
    #[arg(long, default_value_t = 5)]
    runs: u64,
    /// Demos whose draws are computed with, with seeds from 1001 on
    #[arg(long, default_value_t = 60)]
    derived: u64,
    /// Demos whose angles are held against the truth, with seeds from 2101 on
    #[arg(long, default_value_t = 40)]
    angles: u64,
    /// Parts to run, separated by commas; tables.md is written by all together [default: all]
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Folder of the figure [default: that of the tables]
    #[arg(long)]
    images: Option<PathBuf>,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    options: ProgramOptions,
}

impl Args {
    fn has(&self, part: Part) -> bool {
        self.only.is_empty() || self.only.contains(&part)
    }

    fn runs(&self) -> Range<u64> {
        FIRST_RUN..FIRST_RUN + self.runs
    }

    fn demos(&self) -> Range<u64> {
        FIRST_SEED..FIRST_SEED + self.seeds
    }

    fn rigs(&self) -> Range<u64> {
        FIRST_RIG..FIRST_RIG + self.rigs
    }

    /// As many rigs again: what is a chance of the first ones is not seen in these.
    fn other_rigs(&self) -> Range<u64> {
        self.rigs().end..self.rigs().end + self.rigs
    }

    /// Rigs of what explains the others, fewer.
    fn fewer_rigs(&self) -> Range<u64> {
        FIRST_RIG..FIRST_RIG + self.rigs.min(FEWER_RIGS)
    }

    fn angles(&self) -> Range<u64> {
        FIRST_ANGLES..FIRST_ANGLES + self.angles
    }

    fn derived(&self) -> Range<u64> {
        FIRST_DERIVED..FIRST_DERIVED + self.derived
    }
}

/// Rigs whose keypoints lie at the joints, and whose draws are compared with runs of their own constants, at most.
const FEWER_RIGS: u64 = 60;

/// Raised with every change of what a cell computes.
const VERSION: u32 = 5;

/// Cells of cameras that are left out.
fn left_out<'a>(program: &'a Program, recording: &'a Recording, seed: u64) -> Vec<Task<'a>> {
    let task = |used: Vec<&'static str>| -> Task<'a> {
        (recording.cell(&used, seed), 8.0, Box::new(move || left_out::cell(program, recording, &used, seed)))
    };
    recording.sets().into_iter().map(task).collect()
}

/// Cells of the recording that was tuned on.
fn real<'a>(args: &Args, program: &'a Program, recording: &'a Recording, seed: u64) -> Vec<Task<'a>> {
    let mut tasks = if args.has(Part::LeftOut) { left_out(program, recording, seed) } else { vec![] };
    for used in recording.sets().into_iter().filter(|_| args.has(Part::Scores)) {
        let name = scores::name(&used, seed);
        tasks.push((name, 14.0, Box::new(move || scores::cell(program, recording, &used, seed))));
    }
    for both in pairs::DISJOINT.into_iter().filter(|_| args.has(Part::Pairs)) {
        let task = move || pairs::cell(program, recording, both, seed);
        tasks.push((pairs::name(both, seed), 8.0, Box::new(task)));
    }
    if args.has(Part::Triangulation) {
        let task = move || triangulation::cell(program, recording, seed);
        tasks.push((format!("{}/{seed}", triangulation::CELLS), 4.0, Box::new(task)));
    }
    if args.has(Part::Straight) {
        let task = move || straight::recording_cell(program, recording, seed);
        tasks.push((format!("{}/{seed}", straight::RECORDINGS), 40.0, Box::new(task)));
    }
    tasks
}

/// Cells of simulations.
fn simulated<'a>(args: &Args, program: &'a Program) -> Vec<Task<'a>> {
    type Cell = fn(&Program, u64) -> Outcome<Value>;
    let all_rigs = args.rigs().start..args.other_rigs().end;
    let kinds: [(Part, &str, Range<u64>, f64, Cell); 8] = [
        (Part::Rigs, rigs::CELLS, all_rigs, 3.0, rigs::cell),
        (Part::AtJoints, rigs::CELLS_AT_JOINTS, args.fewer_rigs(), 3.0, rigs::cell_at_joints),
        (Part::RigPairs, rigs::two_cameras::CELLS, args.rigs(), 3.0, rigs::two_cameras::cell),
        (Part::Straight, straight::RIGS, args.fewer_rigs(), 20.0, straight::rig_cell),
        (Part::Derived, derived::CELLS, args.derived(), 7.0, derived::cell),
        (Part::Angles, angles::CELLS, args.angles(), 5.0, angles::cell),
        (Part::Standing, standing::CELLS, args.angles(), 8.0, standing::cell),
        (Part::Demos, demos::CELLS, args.demos(), 2.0, demos::cell),
    ];
    let mut tasks: Vec<Task<'a>> = vec![];
    for (part, kind, seeds, work, cell) in kinds {
        for seed in seeds.filter(|_| args.has(part)) {
            tasks.push((format!("{kind}/{seed}"), work, Box::new(move || cell(program, seed))));
        }
    }
    tasks
}

/// The tables of all parts, in the order of their numbers on the page, or only the tables of parts that were run.
fn tables(args: &Args, store: &Store, [tuned_on, untouched]: [&Recording; 2]) -> Outcome<String> {
    let all = [
        (vec![Part::Demos], demos::table(store, args.demos())),
        (vec![Part::LeftOut], left_out::table(store, tuned_on, args.runs())),
        (vec![Part::Pairs], pairs::table(store, args.runs())),
        (vec![Part::Rigs], rigs::table(store, args.rigs())),
        (vec![Part::Derived], derived::table(store, args.derived())),
        (vec![Part::Scores], scores::table(store, &args.runs())),
        (vec![Part::Scores, Part::Derived], reliability::table(store, [args.runs(), args.derived()])),
        (vec![Part::Caliscope], left_out::table(store, untouched, args.runs())),
        (vec![Part::Rigs], rigs::elbow_table(store, args.rigs())?),
        (vec![Part::AtJoints], rigs::at_joints_table(store, args.fewer_rigs())?),
        (vec![Part::LeftOut], left_out::kinds_table(store, tuned_on, args.runs())?),
        (vec![Part::Caliscope], left_out::kinds_table(store, untouched, args.runs())?),
        (vec![Part::Straight], straight::table(store, args.runs(), args.fewer_rigs())?),
        (vec![Part::Triangulation], triangulation::table(store, args.runs())),
        (vec![Part::RigPairs], rigs::two_cameras::table(store, args.rigs())),
        (vec![Part::Rigs], rigs::table(store, args.other_rigs())),
    ];
    let wanted = all.into_iter().filter(|(parts, _)| parts.iter().any(|part| args.has(*part)));
    Ok(wanted.map(|(_, table)| table).collect::<Vec<_>>().join("\n"))
}

/// The tables of docs/evidence/angles.md.
fn tables_of_angles(args: &Args, store: &Store) -> String {
    let mut text = String::new();
    if args.has(Part::Angles) {
        text += &(angles::table(store, args.angles()) + "\n" + &angles::each_table(store, args.angles()));
    }
    if args.has(Part::Standing) {
        text += &("\n".to_owned() + &standing::table(store, args.angles()));
    }
    text
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let (data, program) = (args.options.data(root), args.options.program(root, "intervals")?);
    let folder = program.folder.clone();
    let recording = tuned_on(&data.join("pose2sim_single"));
    let (source, untouched) = (data.join("caliscope_gesture"), caliscope::recording(&folder.join("caliscope")));
    let images = args.images.as_ref().unwrap_or(&folder);
    std::fs::create_dir_all(images).map_err(|e| format!("{}: {e}", images.display()))?;
    let mut store = Store::open(&folder, &format!("version {VERSION}"))?;
    let is_there = recording.calibration.is_file();
    let mut tasks = vec![];
    for seed in args.runs().filter(|_| is_there) {
        tasks.extend(real(args, &program, &recording, seed));
    }
    if args.has(Part::Caliscope) && source.is_dir() {
        caliscope::converted(&source, &folder.join("caliscope"))?;
        args.runs().for_each(|seed| tasks.extend(left_out(&program, &untouched, seed)));
    }
    tasks.extend(simulated(args, &program));
    run_all(&mut store, "intervals", tasks, threads(args.threads))?;
    let text = tables(args, &store, [&recording, &untouched])?;
    if args.only.is_empty() && is_there && source.is_dir() {
        std::fs::write(folder.join("tables.md"), &text)?;
    }
    if args.has(Part::Angles) && args.has(Part::Standing) {
        std::fs::write(folder.join("angles.md"), tables_of_angles(args, &store))?;
    }
    if !args.only.is_empty() {
        println!("{}", tables_of_angles(args, &store));
    }
    reliability::draw(&store, [args.runs(), args.derived()], &images.join("reliability.svg"))?;
    println!("{text}");
    Ok(())
}
