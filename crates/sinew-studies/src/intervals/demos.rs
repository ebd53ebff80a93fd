//! Demos of many seeds against their truth, from the files that they leave.
//!
//! A run's common shift is the mean of truth − mean over frames, joints and axes of one kind. Its standard deviation is the root of what the total variance of the points has beyond that within the run; within the run it is taken off.

use super::protocol::{LEAST_P, NOMINAL, WITHIN};
use super::summary::{normal_rank, shown, uniformity};
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::{mean, mean_and_error, verdict};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row};
use serde_json::{Value, json};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::formats::{tidy_csv, trc};
use std::ops::Range;
use std::path::Path;

/// A point on one axis: truth − mean, standard deviations in all and within the run, and whether the interval has the truth.
struct Coordinate {
    axis: usize,
    error: f64,
    sd: f64,
    within: f64,
    is_inside: bool,
    half_width: f64,
}

fn coordinates(folder: &Path) -> Outcome<Vec<Coordinate>> {
    let truth = trc::read("truth.trc", &std::fs::read_to_string(folder.join("truth.trc"))?)?;
    let table = tidy_csv::read_cells("joints.csv", &std::fs::read_to_string(folder.join("joints.csv"))?)?;
    let column = |name: &str| table.columns.iter().position(|column| column == name).ok_or(format!("no column {name}"));
    let [frame, joint] = [column("frame")?, column("joint")?];
    let mut found = vec![];
    for (_, row) in &table.rows {
        let Some(marker) = truth.header.markers.iter().position(|name| *name == row[joint]) else { continue };
        if !EVALUATION_JOINTS.contains(&row[joint].as_str()) {
            continue;
        }
        let Some(at) = truth.point_in_world(row[frame].parse()?, marker) else { continue };
        for (axis, (name, at)) in ["x", "y", "z"].into_iter().zip(at).enumerate() {
            let number = |what: &str| -> Outcome<f64> { Ok(row[column(&format!("{name}_{what}_m"))?].parse()?) };
            let [mean, sd, low, high, within] =
                [number("mean")?, number("sd")?, number("q05")?, number("q95")?, number("sd_within")?];
            let is_inside = (low..=high).contains(&at);
            found.push(Coordinate { axis, error: at - mean, sd, within, is_inside, half_width: 0.5 * (high - low) });
        }
    }
    Ok(found)
}

/// What the names of cells begin with.
pub(super) const CELLS: &str = "demo";

/// One demo.
pub(super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    let folder = program.folder.join(format!("demo-{seed}"));
    let flags = ["demo", "--json", "--threads", "1", "--no-progress", "--seed"].map(str::to_owned).to_vec();
    let out = folder.display().to_string();
    let answer = program.run(&[flags, vec![seed.to_string(), "-o".into(), out]].concat(), &[0, 4])?;
    let answer: Value = serde_json::from_str(&answer)?;
    let found = coordinates(&folder)?;
    std::fs::remove_dir_all(&folder)?;
    let on_axis = |axis: usize| found.iter().filter(move |c| c.axis == axis);
    let shift = [0, 1, 2].map(|axis| mean(on_axis(axis).map(|c| c.error)));
    let shift_sd = [0, 1, 2].map(|axis| mean(on_axis(axis).map(|c| c.sd.powi(2) - c.within.powi(2))).max(0.0).sqrt());
    let is_within = |c: &Coordinate| (c.error - shift[c.axis]).abs() <= 1.645 * c.within;
    let standard_shift = [0, 1, 2].map(|axis: usize| shift[axis] / shift_sd[axis]);
    Ok(json!({
        "coverage": 100.0 * mean(found.iter().map(|c| f64::from(u8::from(c.is_inside)))),
        "half_width_mm": 1e3 * mean(found.iter().map(|c| c.half_width)),
        "within": 100.0 * mean(found.iter().map(|c| f64::from(u8::from(is_within(c))))),
        "within_half_width_mm": 1e3 * 1.645 * mean(found.iter().map(|c| c.within)),
        "standard_shift": standard_shift,
        "error_mm": answer["mean_error_mm"],
    }))
}

/// Means over the seeds, with standard errors.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<&Value> = store.for_seeds(CELLS, seeds);
    let of = |name: &str| {
        let values: Vec<f64> = cells.iter().filter_map(|cell| cell[name].as_f64()).collect();
        let [centre, error] = mean_and_error(&values);
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (centre, error, low, high)
    };
    let mut text = format!("{} demos, seeds from {}:\n\n", cells.len(), super::protocol::FIRST_SEED);
    text += &header("| measure | mean over seeds | single seeds | half-width, mm | bound | |");
    for (name, width, what) in [
        ("coverage", "half_width_mm", "inside 90 % intervals, %"),
        ("within", "within_half_width_mm", "the same, common shift taken off both, %"),
    ] {
        let (centre, error, low, high) = of(name);
        let bound = WITHIN.max(3.0 * error);
        let met = verdict((centre - NOMINAL).abs() <= bound);
        let width = of(width).0;
        row!(
            text,
            "{what} | {centre:.1} ± {error:.1} | {low:.0} to {high:.0} | {width:.1} | {NOMINAL} ± {bound:.1} | {met}"
        );
    }
    let (error, spread, low, high) = of("error_mm");
    row!(text, "mean error, mm | {error:.1} ± {spread:.1} | {low:.1} to {high:.1} | | |");
    let shifts: Vec<f64> = cells.iter().flat_map(|cell| numbers(&cell["standard_shift"])).collect();
    let rms = mean(shifts.iter().map(|z| z * z)).sqrt();
    let inside = 100.0 * mean(shifts.iter().map(|z| f64::from(u8::from(z.abs() <= 1.645))));
    row!(
        text,
        "common shift over its standard deviation | root mean square {rms:.2} | | | {inside:.0} % within 1.645 |"
    );
    let p = [0, 1, 2].map(|axis: usize| {
        uniformity(&shifts.iter().skip(axis).step_by(3).map(|z| normal_rank(*z)).collect::<Vec<_>>())
    });
    let least = p.iter().fold(1.0, |least: f64, p| least.min(3.0 * p));
    let met = verdict(least >= LEAST_P);
    row!(
        text,
        "its ranks over the seeds uniform: p along x, y, z | {} | | | 3 × the least ≥ {LEAST_P} | {met}",
        p.map(shown).join(", ")
    );
    text
}
