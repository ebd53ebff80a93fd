//! `cargo xtask verify [--nightly] [--seed S]`: every statistical check in a row, with a page of results.
//!
//! Random checks run in stages until their evidence is clear (the kit's `Control`), so that a rotating seed does not cry wolf: the page says how likely one false alarm among all of them is.

use crate::coverage;
use crate::support::table::{header, row};
use clap::Args as ClapArgs;
use rayon::prelude::*;
use sinew_tests::checks::{CHECKS, Check, Run};
use sinew_tests::outcome::Outcome;
use sinew_tests::size::Size;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// Options.
#[derive(ClapArgs)]
pub struct Args {
    /// Full size, ten to twelve minutes on two cores; without it the size of the ordinary suite.
    #[arg(long)]
    nightly: bool,
    /// Seed of all checks; by default the number of the day, so that it turns.
    #[arg(long)]
    seed: Option<u64>,
    /// Only these checks, by name.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Folder for the page.
    #[arg(long)]
    out: Option<PathBuf>,
}

/// A check with what it found.
struct Done {
    check: Check,
    outcomes: Vec<Outcome>,
    seconds: f64,
}

impl Done {
    fn verdict(&self) -> &'static str {
        match (self.outcomes.is_empty(), self.outcomes.iter().all(|o| o.holds)) {
            (true, _) => "skipped: no data",
            (_, true) => "holds",
            (_, false) => "does not hold",
        }
    }

    fn failed(&self) -> bool {
        self.verdict() == "does not hold"
    }
}

/// Checks of the library, beside the checks of the layers.
const OF_PEOPLE: Check = Check {
    name: "people",
    claim: "90 % intervals of `sinew track` at its defaults cover 90 ± 3 % where the noise is as assumed",
    run: Run::Outcomes(people),
};

fn people(seed: u64, size: Size) -> Vec<Outcome> {
    let root = crate::support::root();
    let reduced = coverage::Size { ranked: 10, ..coverage::Size::NIGHTLY };
    let length = if size == Size::Full { coverage::Size::NIGHTLY } else { reduced };
    let series = length.ranked;
    let found = coverage::check(root, seed, length);
    let name = format!("coverage of joints, {series} series of simulated people through four cameras");
    let outcome = match found {
        Ok(found) => {
            let at_90 = found.promised.iter().position(|&level| level == 0.9).unwrap_or(0);
            let (coverage, error) = (found.coverage[at_90], found.error[at_90]);
            // Few series scatter beyond the target; the full size has none to spare.
            let allowance = if size == Size::Full { 0.0 } else { 2.0 };
            Outcome {
                name,
                holds: (coverage - 0.9).abs() <= 0.03 + allowance * error,
                worst: format!(
                    "{:.1} ± {:.1} %, 90 ± 3 % and {allowance} standard errors",
                    100.0 * coverage,
                    100.0 * error
                ),
                false_alarm_rate: 0.0,
                statistics: 1,
                stages: 1,
            }
        }
        Err(error) => {
            Outcome { name, holds: false, worst: error.to_string(), false_alarm_rate: 0.0, statistics: 1, stages: 1 }
        }
    };
    vec![outcome]
}

/// The angles too, also the one that no keypoint determines.
const OF_DEGREES: Check = Check {
    name: "degrees-of-freedom",
    claim: "the ranks of all 32 degrees of freedom of H32 are uniform on motion that the tracker's own model draws, as far as the series show",
    run: Run::Outcomes(degrees),
};

/// Probability of a false alarm of [`degrees`].
const RATE: f64 = 1e-6;

fn degrees(seed: u64, size: Size) -> Vec<Outcome> {
    let series = if size == Size::Full { 300 } else { 60 };
    let (holds, worst) = match coverage::worst_coordinate(series, seed) {
        Ok((name, width, p)) => {
            (p >= RATE, format!("χ² of the ranks of {name}, width {width:.2}: p = {p:.2e}, must exceed {RATE:.0e}"))
        }
        Err(error) => (false, error.to_string()),
    };
    let name = format!("ranks of 32 degrees of freedom, {series} series");
    vec![Outcome { name, holds, worst, false_alarm_rate: RATE, statistics: 32, stages: 1 }]
}

/// Every check there is.
fn all() -> impl Iterator<Item = &'static Check> {
    CHECKS.iter().chain([&OF_PEOPLE, &OF_DEGREES])
}

/// Days since 1970.
fn today() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs() / 86_400)
}

/// Runs the checks.
pub fn run(root: &Path, args: &Args) -> ExitCode {
    let known = |name: &String| all().any(|check| check.name == *name);
    if let Some(name) = args.only.iter().find(|name| !known(name)) {
        let names: Vec<&str> = all().map(|check| check.name).collect();
        eprintln!("error: no check is named `{name}`\nhelp: there are {}", names.join(", "));
        return ExitCode::from(2);
    }
    let size = if args.nightly { Size::Full } else { Size::Reduced };
    let seed = args.seed.unwrap_or_else(today);
    let chosen: Vec<Check> = all()
        .filter(|check| args.only.is_empty() || args.only.iter().any(|name| name == check.name))
        .copied()
        .collect();
    println!("{} checks, {} size, seed {seed}", chosen.len(), if args.nightly { "full" } else { "reduced" });
    let start = Instant::now();
    let done: Vec<Done> = chosen
        .par_iter()
        .with_max_len(1)
        .map(|check| {
            let from = Instant::now();
            let outcomes = check.outcomes(seed, size);
            let done = Done { check: *check, outcomes, seconds: from.elapsed().as_secs_f64() };
            println!("{:>6.1} s  {}  {}", done.seconds, done.verdict(), check.name);
            done
        })
        .collect();
    let seconds = start.elapsed().as_secs_f64();
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/verify"));
    let name = format!("seed-{seed}{}", if args.nightly { "" } else { "-reduced" });
    let written = std::fs::create_dir_all(&folder)
        .and_then(|()| std::fs::write(folder.join(format!("{name}.md")), page(&done, seed, size, seconds)));
    if let Err(error) = written {
        eprintln!("error: {}: {error}", folder.display());
        return ExitCode::from(5);
    }
    println!("{}", summary(&done, seconds));
    println!("page: {}", folder.join(format!("{name}.md")).display());
    if done.iter().any(Done::failed) { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

/// Probability of at least one failure although all is well, at most.
fn false_alarms(done: &[Done]) -> f64 {
    done.iter().flat_map(|d| &d.outcomes).map(|o| o.false_alarm_rate).sum()
}

fn summary(done: &[Done], seconds: f64) -> String {
    let failed: Vec<&str> = done.iter().filter(|d| d.failed()).map(|d| d.check.name).collect();
    let skipped = done.iter().filter(|d| d.outcomes.is_empty()).count();
    let findings: usize = done.iter().map(|d| d.outcomes.len()).sum();
    let statistics: usize = done.iter().flat_map(|d| &d.outcomes).map(|o| o.statistics).sum();
    let verdict = if failed.is_empty() { "all hold".into() } else { format!("not all hold: {}", failed.join(", ")) };
    format!(
        "{verdict}; {} checks ({skipped} skipped for want of data), {findings} findings, {statistics} statistics, {:.1} minutes; chance of a false alarm at most {:.1e} for those that state one",
        done.len(),
        seconds / 60.0,
        false_alarms(done),
    )
}

fn page(done: &[Done], seed: u64, size: Size, seconds: f64) -> String {
    let mut text = format!("# Checks with seed {seed}, {size:?} size\n\n{}\n\n", summary(done, seconds));
    text += &header("| claim | check | verdict | findings | nearest to its bound | s |");
    for d in done {
        let worst = d.outcomes.iter().find(|o| !o.holds).or_else(|| d.outcomes.iter().max_by_key(|o| o.stages));
        row!(
            text,
            "{} | {} | {} | {} | {} | {:.0}",
            d.check.claim,
            d.check.name,
            d.verdict(),
            d.outcomes.len(),
            worst.map_or_else(String::new, |o| o.worst.replace('|', "\\|")),
            d.seconds
        );
    }
    for d in done.iter().filter(|d| d.failed()) {
        let _ = writeln!(text, "\n## {} fails\n", d.check.name);
        for o in d.outcomes.iter().filter(|o| !o.holds) {
            let _ = writeln!(text, "- {}\n  - {} (stage {})", o.name, o.worst, o.stages);
        }
    }
    text
}
