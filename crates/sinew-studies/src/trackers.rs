//! `cargo xtask study trackers`: all trackers side by side on the same recordings, the tables of docs/reference/trackers.md.
//!
//! Everything goes through the program as a user runs it: recordings and learned models are files, results are read from the folder that a run leaves.
//!
//! | file | what |
//! |---|---|
//! | [`entries`] | the trackers, with the settings and the learned models that each needs |
//! | [`films`] | recordings, and models learned from other walks |
//! | [`worth`] | errors, coverage and speed of a folder of results |
//! | [`tables`] | means over recordings and seeds |

mod entries;
mod films;
pub(crate) mod silhouettes;
mod tables;
pub(crate) mod worth;

use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::store::{Store, Task, run_all};
use crate::support::study_options::ProgramOptions;
use entries::{ENTRIES, Entry};
use films::{Film, key};
use std::path::Path;

/// Tracks the same recordings by all trackers.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Seeds from 1 on, each another person, other errors and other particles
    #[arg(long, default_value_t = 3)]
    seeds: u64,
    /// Runs at a time, one thread each; more than one makes frames a second less
    #[arg(long, default_value_t = 1)]
    threads: usize,
    #[command(flatten)]
    options: ProgramOptions,
}

/// Raised with every change of what a cell computes.
const VERSION: u32 = 2;

/// One run in a folder of its own, which goes when it has been read.
fn cell(program: &Program, film: &Film, entry: &Entry, seed: u64) -> Outcome<serde_json::Value> {
    let out = program.folder.join("runs").join(key(film, entry, seed).replace('/', "-"));
    let mut flags = film.flags(entry.seen, seed);
    flags.extend(entry.flags.iter().map(|&flag| flag.to_owned()));
    flags.extend(films::model_flags(program, entry, film)?);
    let rest = ["--method", entry.method, "--seed", &seed.to_string(), "--threads", "1", "--force", "--no-progress"];
    flags.extend(rest.map(str::to_owned));
    program.track(&flags, &out)?;
    let found = worth::of(&out, &film.truth(seed)?)?;
    std::fs::remove_dir_all(&out)?;
    Ok(found.to_json())
}

/// Runs the command.
pub(crate) fn run(root: &Path, args: &Args) -> Outcome<()> {
    let (data, program) = (args.options.data(root), args.options.program(root, "trackers")?);
    let folder = program.folder.clone();
    let films = films::all(&program, &data, args.seeds)?;
    films::learn(&program, &data, &films)?;
    let mut store = Store::open(&folder, &format!("version {VERSION}, {ENTRIES:?}"))?;
    let (program, films) = (&program, &films);
    let mut tasks: Vec<Task<'_>> = vec![];
    for seed in 1..=args.seeds {
        for film in films {
            for entry in &ENTRIES {
                let run = move || cell(program, film, entry, seed);
                tasks.push((key(film, entry, seed), 1.0, Box::new(run)));
            }
        }
    }
    run_all(&mut store, "trackers", tasks, args.threads)?;
    let text = tables::text(&store, films, args.seeds)?;
    std::fs::write(folder.join("tables.md"), &text)?;
    println!("{text}");
    Ok(())
}
