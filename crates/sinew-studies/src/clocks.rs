//! `cargo xtask study sync`: how well clocks of cameras are found, and what an unknown lag costs. The tables of docs/evidence/sync.md.
//!
//! Simulated walkers before four cameras whose clocks are set ([`recorded`]), and real recordings of which one camera is shifted ([`shifted`]); everything through the program, from files.

mod cost;
mod found;
mod measures;
mod recorded;
mod shifted;

use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::rms;
use crate::support::study_options::ProgramOptions;
use crate::support::table::{header, row};
use measures::inside;
use recorded::{Clocks, Walk};
use std::path::Path;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Walks of each row
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Seed of the first; walks from 1 on were looked at before
    #[arg(long, default_value_t = 101)]
    first: u64,
    /// Only these parts: lags, drifts, shifted, cost
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    #[command(flatten)]
    options: ProgramOptions,
}

/// Frame rates.
const RATES: [f64; 3] = [30.0, 60.0, 120.0];
/// Frames that one camera is late.
const LAGS: [f64; 4] = [0.3, 1.5, 3.4, 7.5];
/// Seconds of a walk.
const WALK_S: f64 = 8.0;
/// Seconds of walks, on the spot, in which a clock drifts.
const DRIFT_S: [f64; 3] = [20.0, 60.0, 180.0];
const DRIFT_PPM: f64 = 100.0;

/// One camera late by a lag, and all cameras late by random lags.
fn lags(program: &Program, args: &Args) -> Outcome<String> {
    let mut text =
        header("| frames a second | late | error, root mean square, frames | largest | inside 90 % intervals, % |");
    for fps in RATES {
        for late in LAGS.map(Some).into_iter().chain([None]) {
            let (mut errors, mut standardised) = (vec![], vec![]);
            for seed in args.first..args.first + args.seeds {
                let clocks = late.map_or_else(|| Clocks::random(seed), |lag| Clocks::one_late(seed, lag));
                let walk = Walk { seed, fps, seconds: WALK_S, treadmill: false, clocks: clocks.clone() };
                let found = found::clocks(program, &walk)?;
                for [error, sd] in found::errors(&found, &clocks) {
                    errors.push(error);
                    standardised.push(error / sd);
                }
            }
            let largest = errors.iter().fold(0.0_f64, |most, error| most.max(error.abs()));
            let late = late.map_or("all, by up to half a frame".into(), |lag| format!("one, by {lag}"));
            row!(text, "{fps} | {late} | {:.3} | {largest:.2} | {:.0}", rms(&errors), inside(&standardised));
        }
    }
    Ok(text)
}

/// One camera's clock runs slow.
fn drifts(program: &Program, args: &Args) -> Outcome<String> {
    let mut text = header(
        "| frames a second | seconds | drift is found, of | error, ppm | its standard deviation, ppm | lag at the ends, error, frames |",
    );
    for fps in RATES {
        for seconds in DRIFT_S {
            let (mut errors, mut sds, mut ends, mut seen) = (vec![], vec![], vec![], 0);
            for seed in args.first..args.first + args.seeds {
                let clocks = Clocks::one_drifting(seed, DRIFT_PPM);
                let walk = Walk { seed, fps, seconds, treadmill: true, clocks: clocks.clone() };
                let found = found::clocks(program, &walk)?;
                let drift = found::drift(&found, &clocks);
                seen += usize::from(drift.is_some());
                errors.extend(drift.map(|[drift, _]| drift - DRIFT_PPM));
                sds.extend(drift.map(|[_, sd]| sd));
                ends.extend(found::end_errors(&found, &clocks, seconds * fps));
            }
            let shown = |values: &[f64]| if values.is_empty() { "–".into() } else { format!("{:.0}", rms(values)) };
            row!(
                text,
                "{fps} | {seconds} | {seen} of {} | {} | {} | {:.3}",
                args.seeds,
                shown(&errors),
                shown(&sds),
                rms(&ends)
            );
        }
    }
    Ok(text)
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let program = args.options.program(root, "sync")?;
    let folder = program.folder.clone();
    type Part = fn(&Program, &Args) -> Outcome<String>;
    let parts: [(&str, Part); 4] = [
        ("lags", lags),
        ("drifts", drifts),
        ("shifted", |program, _| shifted::table(program)),
        ("cost", |program, args| cost::table(program, args.first..args.first + args.seeds)),
    ];
    for (name, part) in
        parts.into_iter().filter(|(name, _)| args.only.is_empty() || args.only.iter().any(|o| o == name))
    {
        let text = part(&program, args)?;
        println!("{name}\n\n{text}");
        std::fs::write(folder.join(format!("{name}.md")), text)?;
    }
    Ok(())
}
