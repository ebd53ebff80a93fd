//! `cargo xtask mutants`: plants bugs in a copy of the workspace and asks which tests see them.
//!
//! The bugs are listed in `tests/planted/`; each names the tests that must see it.
//!
//! 1. The files that git knows are copied to `target/mutants/checkout`, which has a build folder of its own; only files that changed are written, so that a second run builds little.
//! 2. All named tests run on the copy as it is and must pass.
//! 3. For each bug: its text is replaced, its tests are built (a bug that does not build is an error of the list) and run, and the text is put back. *Caught* means that every named test fails by a panic in test code:
//!    an overflow or an index out of range in the library, or a run without end, is not counted.
//!
//! The table says for every bug which test caught it, and the first line of what that test said. A bug that survives, does not apply or does not build makes the exit code 1.

pub mod list;
mod trial;

use crate::checkout;
use list::Bug;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;
use trial::{Outcome, Trial};

/// Options of the command.
#[derive(clap::Args)]
pub struct Args {
    /// Plant only the bugs of these names.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Print the list and plant nothing.
    #[arg(long)]
    list: bool,
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> ExitCode {
    match plant(root, args) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(what) => {
            eprintln!("error: {what}");
            ExitCode::from(5)
        }
    }
}

/// Plants the chosen bugs; the number of those that no test caught.
fn plant(root: &Path, args: &Args) -> Result<usize, String> {
    let all = list::read(root)?;
    if let Some(unknown) = args.only.iter().find(|name| all.iter().all(|bug| bug.name != **name)) {
        return Err(format!("no bug is called `{unknown}`"));
    }
    let bugs: Vec<&Bug> = all.iter().filter(|bug| args.only.is_empty() || args.only.contains(&bug.name)).collect();
    if args.list {
        for bug in bugs {
            println!("{}: {} ({})", bug.name, bug.what, bug.file);
        }
        return Ok(0);
    }
    let checkout = root.join("target/mutants/checkout");
    checkout::copy(root, &checkout, &BTreeSet::new())?;
    let trial = Trial::new(root, &checkout);
    let named: BTreeSet<_> = bugs.iter().flat_map(|bug| &bug.caught_by).collect();
    let started = Instant::now();
    if let Some(what) = trial.failing(&named)? {
        return Err(format!("a named test does not pass without any bug: {what}"));
    }
    println!("{} named tests pass without a bug ({:.0} s)\n", named.len(), started.elapsed().as_secs_f64());
    println!("| bug | caught by | what it said | s |\n|---|---|---|--:|");
    let mut survivors = 0;
    for bug in &bugs {
        let started = Instant::now();
        let outcome = trial.with_bug(bug)?;
        let seconds = started.elapsed().as_secs_f64();
        let name = &bug.name;
        match outcome {
            Outcome::Caught(by) => {
                for (k, (test, said)) in by.iter().enumerate() {
                    let (name, seconds) =
                        if k == 0 { (name.as_str(), format!("{seconds:.0}")) } else { ("", String::new()) };
                    println!("| {name} | {test} | {} | {seconds} |", cell(said));
                }
            }
            Outcome::Missed(why) => {
                survivors += 1;
                println!("| {name} | **not caught** | {} | {seconds:.0} |", cell(&why));
            }
        }
    }
    println!("\n{} bugs planted, {} caught, {survivors} not", bugs.len(), bugs.len() - survivors);
    Ok(survivors)
}

/// Text that fits a cell of a table.
fn cell(text: &str) -> String {
    const LONGEST: usize = 160;
    let text = text.replace('|', "\\|").replace('\n', " ");
    if text.chars().count() <= LONGEST { text } else { text.chars().take(LONGEST).chain(['…']).collect() }
}
