//! Reliability: share held at many levels against the level that was stated.
//!
//! Before and after, as a table and a figure.

use super::derived;
use super::protocol::{CURVE, RELIABILITY};
use super::scores::scored;
use crate::support::chart::{self, BLUE, GREY, Line, Names, ORANGE, Panel, with_bar};
use crate::support::outcome::Outcome;
use crate::support::statistics::{mean_and_error, verdict};
use crate::support::store::Store;
use crate::support::table::{header, row};
use sinew_analysis::validate::ObservationTally;
use sinew_tests::evaluation::ranks;
use std::ops::Range;
use std::path::Path;

/// Shares held at the levels of [`CURVE`] with their standard errors, 0 where there are none.
type Held = Vec<[f64; 2]>;

/// What was judged, after and before.
struct Judged {
    name: String,
    after: Held,
    before: Held,
    /// Each camera and set with the factor that makes 90 % of its regions hold 90 %; empty where there is no such thing.
    fitted: Held,
}

fn from_tally(tally: &ObservationTally) -> Held {
    CURVE.iter().map(|level| [tally.coverage(*level), 0.0]).collect()
}

fn from_seeds(curves: &[Vec<f64>]) -> Held {
    (0..CURVE.len()).map(|level| mean_and_error(&curves.iter().map(|curve| curve[level]).collect::<Vec<_>>())).collect()
}

fn judged(store: &Store, [runs, seeds]: [Range<u64>; 2]) -> Vec<Judged> {
    let cameras_left_out = |size: usize| {
        let scored = scored(store, size, runs.clone())?;
        let name = format!("cameras left out, {size} used");
        let [after, before, fitted] = [&scored.after, &scored.before, &scored.fitted].map(from_tally);
        Some(Judged { name, after, before, fitted })
    };
    let mut all: Vec<Judged> = [3, 2].into_iter().filter_map(cameras_left_out).collect();
    let demos = |kind: &str| derived::curves(store, seeds.clone(), kind, "coordinates");
    let (after, before) = (demos("filtered"), demos("before"));
    if !after.is_empty() {
        all.push(Judged {
            name: "coordinates of demos".into(),
            after: from_seeds(&after),
            before: from_seeds(&before),
            fitted: vec![],
        });
    }
    all
}

/// Mean distance from the diagonal, percent.
fn distance(held: &Held) -> f64 {
    let held: Vec<f64> = held.iter().map(|[share, _]| *share).collect();
    100.0 * ranks::calibration_error(&held, &CURVE)
}

/// Coverage at some levels and calibration errors; `seeds` are of runs of recordings, and of demos.
pub(super) fn table(store: &Store, seeds: [Range<u64>; 2]) -> String {
    let mut text = format!("Reliability over {} levels, mean distance of held from stated shares:\n\n", CURVE.len());
    text += &header(
        "| what | held at 50, 80, 90, 95 %, % | calibration error, % | each camera and set with its own factor, % | before: held, % | calibration error, % | bound | |",
    );
    for Judged { name, after, before, fitted } in judged(store, seeds) {
        let held = |held: &Held| {
            let at = |level: f64| CURVE.iter().position(|known| (known - level).abs() < 1e-9).unwrap_or_default();
            ranks::LEVELS.map(|level| format!("{:.0}", 100.0 * held[at(level)][0])).join(", ")
        };
        let (error, error_before) = (distance(&after), distance(&before));
        let met = verdict(error <= RELIABILITY);
        let fitted = if fitted.is_empty() { String::new() } else { format!("{:.1}", distance(&fitted)) };
        row!(
            text,
            "{name} | {} | {error:.1} | {fitted} | {} | {error_before:.1} | ≤ {RELIABILITY} | {met}",
            held(&after),
            held(&before)
        );
    }
    text
}

/// Draws the curves, a panel for each thing that was judged.
pub(super) fn draw(store: &Store, seeds: [Range<u64>; 2], path: &Path) -> Outcome<()> {
    let judged = judged(store, seeds);
    if judged.is_empty() {
        return Ok(());
    }
    let line = |name: &str, colour, held: &Held| {
        let point = |(level, share): (&f64, &[f64; 2])| with_bar(*level, *share).map(|x| 100.0 * x);
        Line { name: name.into(), colour, points: CURVE.iter().zip(held).map(point).collect() }
    };
    let diagonal: Held = CURVE.iter().map(|level| [*level, 0.0]).collect();
    let panel = |Judged { name, after, before, .. }: &Judged| {
        let lines = vec![line("stated", GREY, &diagonal), line("before", ORANGE, before), line("now", BLUE, after)];
        let (title, axes) = (name.clone(), ["stated, %", "held, %"]);
        Panel { title, axes, lines, in_decades: [false; 2], names: Names::Beside(64) }
    };
    let panels: Vec<Panel<'_>> = judged.iter().map(panel).collect();
    chart::draw(path, (400 * judged.len() as u32, 380), (1, judged.len()), &panels)
}
