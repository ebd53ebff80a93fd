//! `cargo xtask study gait`: how well gait is read from tracked walkers, the tables of docs/evidence/gait.md.
//!
//! Everything goes through the program as a user runs it: `track`, then `gait`. Truth ([`mod@truth`]) shares no code with its detector.

mod recorded_walks;
mod truth;
mod walkers;

use crate::support::outcome::Outcome;
use crate::support::statistics::{mean, rms, with_error};
use crate::support::store::{Store, Task, numbers, rows, run_all};
use crate::support::study_options::{ProgramOptions, threads};
use crate::support::table::{header, row};
use serde_json::Value;
use std::ops::Range;
use std::path::Path;

/// Measures gait on simulated walkers.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Walkers
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// Seed of the first; windows and thresholds were chosen on seeds 1 to 10
    #[arg(long, default_value_t = 101)]
    first: u64,
    /// Cells that run at a time, one thread each [default: one a processor]
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    options: ProgramOptions,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;

/// A way to record and to track.
struct Way {
    rate_hz: f64,
    /// Correlation of the detector's errors between frames.
    persistence: f64,
    smooth: bool,
}

const WAYS: [Way; 6] = [
    Way { rate_hz: 30.0, persistence: 0.0, smooth: true },
    Way { rate_hz: 30.0, persistence: 0.0, smooth: false },
    Way { rate_hz: 60.0, persistence: 0.0, smooth: true },
    Way { rate_hz: 60.0, persistence: 0.0, smooth: false },
    Way { rate_hz: 60.0, persistence: 0.7, smooth: true },
    Way { rate_hz: 60.0, persistence: 0.7, smooth: false },
];

impl Way {
    fn key(&self, seed: u64) -> String {
        format!("walker/{}/{}/{}/{seed}", self.rate_hz, self.persistence, self.smooth)
    }

    fn shown(&self) -> String {
        let kind = if self.smooth { "smoothed" } else { "filtered" };
        format!("{} | {} | {kind}", self.rate_hz, self.persistence)
    }
}

/// What is shown of the parameters: name, words, factor and unit.
const SHOWN: [(&str, &str, f64); 8] = [
    ("step_length_m", "step length, mm", 1e3),
    ("stride_length_m", "stride length, mm", 1e3),
    ("step_width_m", "step width, mm", 1e3),
    ("step_time_s", "step time, ms", 1e3),
    ("stride_time_s", "stride time, ms", 1e3),
    ("speed_m_per_s", "speed, mm/s", 1e3),
    ("stance_share", "stance, % of the cycle", 1e2),
    ("double_support_share", "double support, % of the cycle", 1e2),
];

/// Shares inside the intervals of errors with ends, in each seed, per cent.
fn inside(seeds: &[Vec<Vec<f64>>]) -> Vec<f64> {
    let share = |all: &Vec<Vec<f64>>| {
        100.0 * all.iter().filter(|x| x[1] <= 0.0 && 0.0 <= x[2]).count() as f64 / all.len() as f64
    };
    seeds.iter().filter(|all| !all.is_empty()).map(share).collect()
}

/// Mean error of each seed, over the seeds.
fn bias(seeds: &[Vec<Vec<f64>>], factor: f64) -> String {
    with_error(&seeds.iter().map(|all| mean(all.iter().map(|x| factor * x[0]))).collect::<Vec<f64>>(), 1)
}

fn column(seeds: &[Vec<Vec<f64>>], value: impl Fn(&Vec<f64>) -> f64) -> Vec<f64> {
    seeds.iter().flatten().map(value).collect()
}

/// Frames a second of recorded walks.
const RATES: [f64; 2] = [30.0, 60.0];

fn recorded() -> impl Iterator<Item = (f64, &'static str)> {
    RATES.into_iter().flat_map(|rate_hz| recorded_walks::WALKS.into_iter().map(move |walk| (rate_hz, walk)))
}

fn recorded_key(rate_hz: f64, walk: &str) -> String {
    format!("recorded with toes/{rate_hz}/{walk}")
}

/// Rows of events for groups of cells, whose first columns are of the given names.
fn event_table(names: &str, groups: &[(String, Vec<&Value>)]) -> String {
    let mut text = header(&format!(
        "| {names} | event | found | missed | extra | mean error, ms | root mean square, ms | half-width, ms | inside 90 %, % | contact less extremum, ms |"
    ));
    for (group, cells) in groups {
        for (key, words) in [("heel_strike", "heel strike"), ("toe_off", "toe off")] {
            let seeds: Vec<Vec<Vec<f64>>> = cells.iter().map(|cell| rows(&cell["events"][key])).collect();
            let count = |what: &str| cells.iter().filter_map(|cell| cell["events"][what].as_u64()).sum::<u64>();
            let errors = column(&seeds, |x| 1e3 * x[0]);
            row!(
                text,
                "{group} | {words} | {} | {} | {} | {} | {:.1} | {:.1} | {} | {:.0}",
                errors.len(),
                count("missed"),
                count("extra"),
                bias(&seeds, 1e3),
                rms(&errors),
                mean(column(&seeds, |x| 500.0 * (x[2] - x[1]))),
                with_error(&inside(&seeds), 1),
                mean(column(&seeds, |x| 1e3 * x[3])),
            );
        }
    }
    text
}

/// Rows of parameters for ways of one kind of results.
fn parameter_table(cells: &[&(&Way, Vec<&Value>)]) -> String {
    let mut text = header(
        "| frames a second | persistence | parameter | mean error | root mean square, a stride | half-width | inside 90 %, a stride, % | root mean square, mean of a walk | inside 90 %, mean of a walk, % |",
    );
    for (way, cells) in cells {
        for (key, words, factor) in SHOWN {
            let seeds: Vec<Vec<Vec<f64>>> =
                cells.iter().map(|cell| rows(&cell["parameters"]["strides"][key])).collect();
            let means: Vec<Vec<Vec<f64>>> =
                cells.iter().map(|cell| vec![numbers(&cell["parameters"]["means"][key])]).collect();
            row!(
                text,
                "{} | {} | {words} | {} | {:.1} | {:.1} | {} | {:.1} | {}",
                way.rate_hz,
                way.persistence,
                bias(&seeds, factor),
                rms(&column(&seeds, |x| factor * x[0])),
                mean(column(&seeds, |x| 0.5 * factor * (x[2] - x[1]))),
                with_error(&inside(&seeds), 1),
                rms(&column(&means, |x| factor * x[0])),
                with_error(&inside(&means), 1),
            );
        }
    }
    text
}

/// All tables, in the order of their numbers on the page.
fn tables(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<(&Way, Vec<&Value>)> =
        WAYS.iter().map(|way| (way, seeds.clone().filter_map(|seed| store.get(&way.key(seed))).collect())).collect();
    let walks = |rate_hz: f64| {
        let keys = recorded_walks::WALKS.iter().map(|walk| recorded_key(rate_hz, walk));
        (format!("{rate_hz}"), keys.filter_map(|key| store.get(&key)).collect::<Vec<_>>())
    };
    let shown: Vec<(String, Vec<&Value>)> = cells.iter().map(|(way, cells)| (way.shown(), cells.clone())).collect();
    let [smoothed, filtered] = [true, false].map(|smooth| {
        let own: Vec<_> = cells.iter().filter(|(way, _)| way.smooth == smooth).collect();
        parameter_table(&own)
    });
    let ways = "frames a second | persistence | results";
    [event_table(ways, &shown), smoothed, filtered, event_table("frames a second", &[walks(RATES[0]), walks(RATES[1])])]
        .join("\n")
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let program = args.options.program(root, "gait")?;
    let folder = program.folder.clone();
    let data = args.options.data(root);
    let mut store = Store::open(&folder, &format!("version {VERSION}"))?;
    let seeds = args.first..args.first + args.seeds;
    let mut tasks: Vec<Task<'_>> = vec![];
    for way in &WAYS {
        for seed in seeds.clone() {
            let program = &program;
            let task = move || walkers::cell(program, seed, way.rate_hz, way.persistence, way.smooth);
            tasks.push((way.key(seed), way.rate_hz, Box::new(task)));
        }
    }
    for (rate_hz, walk) in recorded() {
        if data.join("cmu_amc").is_dir() {
            let (program, data) = (&program, &data);
            let task = move || recorded_walks::cell(program, data, walk, rate_hz);
            tasks.push((recorded_key(rate_hz, walk), rate_hz, Box::new(task)));
        }
    }
    run_all(&mut store, "gait", tasks, threads(args.threads))?;
    let text = tables(&store, seeds);
    println!("{text}");
    Ok(std::fs::write(folder.join("tables.md"), text)?)
}
