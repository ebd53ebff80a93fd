//! `cargo xtask intervals`: what intervals are worth where users stand, the tables of docs/evidence/intervals.md.
//!
//! Everything goes through the program as a user runs it: `demo`, `track` and `predict`. What is predicted is held against keypoints by this study's own code.
//!
//! The bounds of [`protocol`] were fixed before the first run; docs/evidence/intervals.md says what was tuned, and on what.
//!
//! | file | what |
//! |---|---|
//! | [`demos`] | demos of many seeds: coverage of true coordinates, in all and within a run |
//! | [`left_out`] | cameras that a run did not use, predicted |
//! | [`pairs`] | runs of disjoint pairs of cameras, against each other |
//! | [`protocol`] | what is run, and the bounds |

mod demos;
mod left_out;
mod pairs;
mod protocol;

use crate::outcome::{Outcome, exit_code};
use crate::program::{self, Program};
use crate::store::{Store, Task, run_all};
use crate::study_options::StudyOptions;
use protocol::{FIRST_SEED, Recording, sets};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Judges intervals by cameras that are left out and by demos.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Demos, with seeds from 101 on
    #[arg(long, default_value_t = 400)]
    seeds: u64,
    /// The program `sinew` [default: it is built]
    #[arg(long)]
    program: Option<PathBuf>,
    #[command(flatten)]
    options: StudyOptions,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 1;
fn measure(root: &Path, args: &Args) -> Outcome<()> {
    let (data, folder) = (args.options.data(root), args.options.folder(root, "intervals")?);
    let path = match &args.program {
        Some(path) => path.clone(),
        None => program::built(root)?,
    };
    let program = Program { path, folder: folder.clone() };
    let real = data.join("pose2sim_single");
    let recording = Recording { calibration: real.join("Calib.toml"), keypoints: real.join("T01_BalancingTrial/pose") };
    let is_there = recording.calibration.is_file();
    let mut store = Store::open(&folder, &format!("version {VERSION}"))?;
    let (program, recording) = (&program, &recording);
    let mut tasks: Vec<Task<'_>> = vec![];
    if is_there {
        for used in [sets(3), sets(2)].concat() {
            let key = format!("left out/{}", used.join("+"));
            tasks.push((key, 8.0, Box::new(move || left_out::cell(program, recording, &used))));
        }
        for [a, b] in pairs::DISJOINT {
            tasks.push((format!("pairs/{a:?}"), 8.0, Box::new(move || pairs::cell(program, recording, [a, b]))));
        }
    }
    for seed in FIRST_SEED..FIRST_SEED + args.seeds {
        tasks.push((format!("demo/{seed}"), 2.0, Box::new(move || demos::cell(program, seed))));
    }
    run_all(&mut store, "intervals", tasks, args.options.threads())?;
    let mut text = String::new();
    writeln!(text, "{}", demos::table(&store, FIRST_SEED..FIRST_SEED + args.seeds))?;
    if is_there {
        writeln!(text, "{}", left_out::table(&store))?;
        writeln!(text, "{}", pairs::table(&store))?;
    }
    std::fs::write(folder.join("tables.md"), &text)?;
    println!("{text}");
    Ok(())
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> ExitCode {
    exit_code(measure(root, args))
}
