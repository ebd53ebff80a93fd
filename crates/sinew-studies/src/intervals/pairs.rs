//! Runs of disjoint pairs of cameras: is their difference as large as they say?

use super::protocol::{CAMERAS, PAIRS, Recording};
use super::summary::over_seeds;
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::{mean, verdict};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row};
use serde_json::{Value, json};
use sinew::formats::tidy_csv;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// The three ways to part four cameras in two pairs.
pub(super) const DISJOINT: [[[usize; 2]; 2]; 3] = [[[0, 1], [2, 3]], [[0, 2], [1, 3]], [[0, 3], [1, 2]]];

/// Mean, total standard deviation and that within the run of each joint in each frame.
type Joints = BTreeMap<(u64, String), [[f64; 3]; 3]>;

fn joints(folder: &Path) -> Outcome<Joints> {
    let table = tidy_csv::read_cells("joints.csv", &std::fs::read_to_string(folder.join("joints.csv"))?)?;
    let column = |name: String| table.columns.iter().position(|column| *column == name).ok_or(format!("no {name}"));
    let places = ["mean", "sd", "sd_within"].map(|what| ["x", "y", "z"].map(|axis| column(format!("{axis}_{what}_m"))));
    let mut found = Joints::new();
    for (_, row) in &table.rows {
        let mut numbers = [[0.0; 3]; 3];
        for (numbers, places) in numbers.iter_mut().zip(&places) {
            for (number, place) in numbers.iter_mut().zip(places) {
                *number = row[place.clone()?].parse()?;
            }
        }
        found.insert((row[column("frame".into())?].parse()?, row[column("joint".into())?].clone()), numbers);
    }
    Ok(found)
}

/// Two runs and their difference.
pub(super) fn cell(program: &Program, recording: &Recording, pairs: [[usize; 2]; 2], seed: u64) -> Outcome<Value> {
    let run = |pair: [usize; 2]| -> Outcome<Joints> {
        let folder = program.folder.join(format!("pair-{}-{}-{seed}", pair[0], pair[1]));
        program.track(&recording.flags(&pair.map(|c| CAMERAS[c]), seed), &folder)?;
        let found = joints(&folder)?;
        std::fs::remove_dir_all(&folder)?;
        Ok(found)
    };
    let [a, b] = [run(pairs[0])?, run(pairs[1])?];
    let both = a.iter().filter_map(|(key, a)| Some((a, b.get(key)?)));
    let sd = |a: &[[f64; 3]; 3], b: &[[f64; 3]; 3], kind: usize, axis: usize| a[kind][axis].hypot(b[kind][axis]);
    let difference = |(a, b): (&[[f64; 3]; 3], &[[f64; 3]; 3])| {
        [0, 1, 2].map(|axis: usize| [a[0][axis] - b[0][axis], sd(a, b, 1, axis), sd(a, b, 2, axis)])
    };
    let differences: Vec<[[f64; 3]; 3]> = both.map(difference).collect();
    let count = differences.len() as f64;
    let shift = [0, 1, 2].map(|axis: usize| differences.iter().map(|d| d[axis][0]).sum::<f64>() / count);
    let inside = |shift: [f64; 3], kind: usize| {
        let is_inside = |(axis, numbers): (usize, &[f64; 3])| (numbers[0] - shift[axis]).abs() <= 1.645 * numbers[kind];
        let inside = differences.iter().flat_map(|d| d.iter().enumerate()).filter(|pair| is_inside(*pair)).count();
        100.0 * inside as f64 / (3.0 * count)
    };
    let half_width =
        |kind: usize| 1.645 * differences.iter().flatten().map(|numbers| numbers[kind]).sum::<f64>() / (3.0 * count);
    let mut sizes: Vec<f64> =
        differences.iter().flat_map(|d| [0, 1, 2].map(|axis: usize| (d[axis][0] - shift[axis]).abs())).collect();
    sizes.sort_by(f64::total_cmp);
    Ok(json!({
        "shift_mm": shift.map(|x| 1e3 * x),
        "as_they_are": inside([0.0; 3], 1),
        "without_shift": inside(shift, 1),
        "within": inside(shift, 2),
        "half_width_mm": 1e3 * half_width(1),
        "within_half_width_mm": 1e3 * half_width(2),
        "needed_mm": 1e3 * sizes[(0.9 * (sizes.len() - 1) as f64).round() as usize],
    }))
}

/// Name of the cell of two pairs.
pub(super) fn name([a, b]: [[usize; 2]; 2], seed: u64) -> String {
    format!("pairs/{a:?} {b:?}/{seed}")
}

/// The table, for runs of some seeds.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let mut text =
        "Disjoint pairs of cameras, difference of the means inside its 90 % interval, all frames; mean ± standard deviation over seeds:\n\n".to_owned();
    text += &header(
        "| pairs | inside, common shift taken off, % | not taken off, % | half-width, mm | 90 % of differences, mm | spread within the runs alone: inside, % | half-width, mm | common shift, mm | bound | |",
    );
    for pairs in DISJOINT {
        let cells: Vec<&Value> = seeds.clone().filter_map(|seed| store.get(&name(pairs, seed))).collect();
        if cells.is_empty() {
            continue;
        }
        let each =
            |name: &str| -> Vec<f64> { cells.iter().map(|cell| cell[name].as_f64().unwrap_or(f64::NAN)).collect() };
        let shown = |name: &str| over_seeds(&each(name));
        let along = |axis: usize| mean(cells.iter().map(|cell| numbers(&cell["shift_mm"])[axis]));
        let [x, y, z] = [0, 1, 2].map(|axis: usize| format!("{:.0}", along(axis)));
        let [a, b] = pairs.map(|pair| pair.map(|camera| CAMERAS[camera]).join(" "));
        row!(
            text,
            "{a} against {b} | {} | {} | {} | {} | {} | {} | {x}, {y}, {z} | ≥ {PAIRS} | {}",
            shown("without_shift"),
            shown("as_they_are"),
            shown("half_width_mm"),
            shown("needed_mm"),
            shown("within"),
            shown("within_half_width_mm"),
            verdict(mean(each("without_shift").into_iter()) >= PAIRS)
        );
    }
    text
}
