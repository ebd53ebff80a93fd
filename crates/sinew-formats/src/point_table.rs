//! Trajectories of named points as a table of numbers: `time_s`, then `<point>_x_m`, `<point>_y_m`, `<point>_z_m`.
//!
//! World axes (Z up), metres. This is what motion files become when they are converted to CSV and what CSV must look
//! like to become a motion file.
//!
//! ```
//! use sinew_formats::{point_table, tidy_csv};
//! let table = tidy_csv::read_numbers("a.csv", "time_s,RHip_x_m,RHip_y_m,RHip_z_m\n0.0,1,2,3\n")?;
//! let points = point_table::from_numbers("a.csv", &table)?;
//! assert_eq!(points.names, ["RHip"]);
//! assert_eq!(points.frames[0], [Some([1.0, 2.0, 3.0])]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::limits::{MAX_POINTS, check_count};
use crate::tidy_csv::{Cell, Numbers, write_row};
use crate::{Error, Place};
use std::collections::HashMap;
use std::io::{self, Write};

/// Trajectories of named points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointTable {
    /// Names of the points.
    pub names: Vec<String>,
    /// Time of each frame, seconds.
    pub time_s: Vec<f64>,
    /// Points of each frame in the world, metres; `None` is missing.
    pub frames: Vec<Vec<Option<[f64; 3]>>>,
}

/// Column names for these points.
#[must_use]
pub fn columns(names: &[impl AsRef<str>]) -> Vec<String> {
    let columns_of = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}_{axis}_m"));
    let points = names.iter().flat_map(|name| columns_of(name.as_ref()));
    std::iter::once("time_s".to_owned()).chain(points).collect()
}

/// Writes a row; a missing point becomes three times `NaN`.
///
/// # Errors
/// What the stream reports; `InvalidInput` for an infinite number.
pub fn write_frame(out: &mut impl Write, time_s: f64, points: &[Option<[f64; 3]>]) -> io::Result<()> {
    let values = points.iter().flat_map(|point| point.unwrap_or([f64::NAN; 3]));
    let cells: Vec<Cell<'_>> = std::iter::once(time_s).chain(values).map(Cell::Number).collect();
    write_row(out, &cells)
}

/// Finds the points in a table of numbers; other columns are ignored.
///
/// # Errors
/// No column `time_s`, a time that is missing, no points or more than [`MAX_POINTS`], a point with fewer than three coordinates.
pub fn from_numbers(name: &str, table: &Numbers) -> Result<PointTable, Error> {
    let missing = |field: &str| Place::file(name).lacks(field);
    let time = table.column("time_s").ok_or_else(|| missing("time_s"))?;
    let names: Vec<String> =
        table.columns.iter().filter_map(|column| Some(column.strip_suffix("_x_m")?.into())).collect();
    if names.is_empty() {
        return Err(missing("<point>_x_m"));
    }
    check_count(|| Place::file(name), names.len(), "points", MAX_POINTS)?;
    let mut places: HashMap<&str, usize> = HashMap::with_capacity(table.columns.len());
    for (place, title) in table.columns.iter().enumerate() {
        places.entry(title).or_insert(place);
    }
    let mut triples: Vec<[usize; 3]> = Vec::with_capacity(names.len());
    for point in &names {
        let column = |axis: &str| {
            let title = format!("{point}_{axis}_m");
            places.get(title.as_str()).copied().ok_or_else(|| missing(&title))
        };
        triples.push([column("x")?, column("y")?, column("z")?]);
    }
    let mut out = PointTable { names, ..PointTable::default() };
    for (index, row) in table.rows.iter().enumerate() {
        let value = |column: usize| row.get(column).copied().filter(|value| !value.is_nan());
        let place = || Place::file(name).within(format!("row {}", index + 1));
        let time_s = value(time).ok_or_else(|| place().lacks("time_s"))?;
        out.time_s.push(time_s);
        let point = |&[x, y, z]: &[usize; 3]| Some([value(x)?, value(y)?, value(z)?]);
        out.frames.push(triples.iter().map(point).collect());
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tidy_csv::{read_numbers, write_header};

    #[test]
    fn points_survive_the_table() {
        let points = PointTable {
            names: vec!["Nose".into(), "R_Hip".into()],
            time_s: vec![0.0, 0.1],
            frames: vec![vec![Some([1.0, -0.0, 1e-7]), None], vec![None, Some([0.1, 0.2, 0.3])]],
        };
        let mut out = Vec::new();
        write_header(&mut out, &columns(&points.names)).unwrap();
        for (time_s, frame) in points.time_s.iter().zip(&points.frames) {
            write_frame(&mut out, *time_s, frame).unwrap();
        }
        let table = read_numbers("a.csv", std::str::from_utf8(&out).unwrap()).unwrap();
        assert_eq!(from_numbers("a.csv", &table).unwrap(), points);
    }

    #[test]
    fn incomplete_points_are_refused() {
        let check = |text: &str, message: &str| {
            let table = read_numbers("a.csv", text).unwrap();
            assert_eq!(from_numbers("a.csv", &table).unwrap_err().to_string(), message);
        };
        check("x,y\n", "a.csv: `time_s` is missing");
        check("time_s,y\n", "a.csv: `<point>_x_m` is missing");
        check("time_s,a_x_m,a_z_m\n", "a.csv: `a_y_m` is missing");
        check("time_s,a_x_m,a_y_m,a_z_m\nNaN,1,2,3\n", "a.csv (row 1): `time_s` is missing");
    }
}
