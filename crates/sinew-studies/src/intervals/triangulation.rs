//! Points that another program triangulated from the same keypoints: how many coordinates lie inside the intervals of a run?
//!
//! The triangulation shares keypoints and their offsets with the run, so that no bound stands on it. It means the detector's keypoints (`keypoints.csv`) more than the joints (`joints.csv`).

use super::protocol::Recording;
use super::summary::over_seeds;
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::mean;
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row};
use serde_json::{Map, Value, json};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::formats::{tidy_csv, trc};
use std::ops::Range;
use std::path::Path;

/// Files of points, and what they are.
const FILES: [(&str, &str); 2] = [
    ("S00_P00_T01_BalancingTrial_0-100.trc", "triangulated"),
    ("S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc", "triangulated and filtered"),
];
/// Tables of a run, the column that names their points, and what they are about.
const TABLES: [(&str, &str, &str); 2] =
    [("joints.csv", "joint", "joints"), ("keypoints.csv", "keypoint", "keypoints in space")];

/// Shares of the coordinates of the joints of limbs inside 90 % intervals, percent, as they are and with the mean difference taken off.
fn inside(folder: &Path, (table, kind, _): (&str, &str, &str), points: &trc::Trc) -> Outcome<[f64; 2]> {
    let table = tidy_csv::read_cells(table, &std::fs::read_to_string(folder.join(table))?)?;
    let column = |name: &str| table.columns.iter().position(|column| column == name).ok_or(format!("no {name}"));
    let [frame, point] = [column("frame")?, column(kind)?];
    let mut found: Vec<(usize, [f64; 3])> = vec![];
    for (_, row) in &table.rows {
        let known =
            EVALUATION_JOINTS.contains(&row[point].as_str()).then(|| points.marker_index(&row[point])).flatten();
        let Some(marker) = known else { continue };
        let Some(at) = points.point_in_world(row[frame].parse()?, marker) else { continue };
        for (axis, (name, at)) in ["x", "y", "z"].into_iter().zip(at).enumerate() {
            let number = |what: &str| -> Outcome<f64> { Ok(row[column(&format!("{name}_{what}_m"))?].parse()?) };
            found.push((
                axis,
                [at - number("mean")?, number("q05")? - number("mean")?, number("q95")? - number("mean")?],
            ));
        }
    }
    let shift = [0, 1, 2].map(|axis| mean(found.iter().filter(|own| own.0 == axis).map(|own| own.1[0])));
    let share = |shift: [f64; 3]| {
        let is_inside = |(axis, [away, low, high]): &(usize, [f64; 3])| (*low..=*high).contains(&(away - shift[*axis]));
        100.0 * mean(found.iter().map(|own| f64::from(u8::from(is_inside(own)))))
    };
    Ok([share([0.0; 3]), share(shift)])
}

/// A run with all cameras against each file.
pub(super) fn cell(program: &Program, recording: &Recording, seed: u64) -> Outcome<Value> {
    let folder = program.folder.join(format!("triangulation-{seed}"));
    program.track(&recording.flags(&recording.cameras, seed), &folder)?;
    let place = recording.keypoints.parent().unwrap_or(&recording.keypoints).join("pose-3d");
    let mut all = Map::new();
    for (file, name) in FILES {
        let points = trc::read(file, &std::fs::read_to_string(place.join(file))?)?;
        for table in TABLES {
            all.insert(format!("{name}, {}", table.2), json!(inside(&folder, table, &points)?));
        }
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(all.into())
}

/// What the names of cells begin with.
pub(super) const CELLS: &str = "triangulation";

/// The table, for runs of some seeds.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<&Value> = store.for_seeds(CELLS, seeds);
    let mut text = "Coordinates that another program triangulated, inside 90 % intervals; mean ± standard deviation over seeds:\n\n".to_owned();
    text += &header("| points | intervals of | inside, % | mean difference taken off, % |");
    for (_, file) in FILES {
        for (.., about) in TABLES {
            let shares = |k: usize| -> Vec<f64> {
                cells.iter().map(|cell| numbers(&cell[format!("{file}, {about}").as_str()])[k]).collect()
            };
            row!(text, "{file} | {about} | {} | {}", over_seeds(&shares(0)), over_seeds(&shares(1)));
        }
    }
    text
}
