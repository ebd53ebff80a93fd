//! CSV tables with the unit in every column name: `time_s`, `RHip_x_m`, `knee_q05_deg`, `residual_px`.
//!
//! Written are commas, decimal points, a header, no blank cells but for values that do not exist, and numbers that read
//! back equal. Cells are quoted where they hold a comma, a quote or a line end. Read are commas, semicolons or tabs,
//! whichever the header uses, and quoted cells; a decimal comma is an error that says so.
//!
//! ```
//! use sinew_formats::tidy_csv::{self, Cell};
//! let mut file = Vec::new();
//! tidy_csv::write_header(&mut file, &["time_s", "name", "mean_deg"])?;
//! tidy_csv::write_row(&mut file, &[Cell::Number(0.5), Cell::Text("knee, left"), Cell::Number(f64::NAN)])?;
//! assert_eq!(file, b"time_s,name,mean_deg\n0.5,\"knee, left\",NaN\n");
//! assert_eq!(tidy_csv::unit("mean_deg"), Some("deg"));
//!
//! let table = tidy_csv::read_numbers("a.csv", "time_s;x_m\r\n0.0;1.5\r\n0.1;\r\n")?;
//! assert_eq!(table.rows[0], [0.0, 1.5]);
//! assert!(table.rows[1][1].is_nan());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::csv_text::records;
use crate::numbers::write_number;
use crate::source_text::{finite_or_missing, shortened, without_mark};
use crate::{Error, Place};
use std::io::{self, Write};

/// Units that column names end with.
const UNITS: [&str; 9] = ["s", "m", "mm", "cm", "px", "deg", "rad", "hz", "ms"];

/// A cell to be written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// A number; NaN is a value that is missing.
    Number(f64),
    /// A count or an index.
    Integer(i64),
    /// A name.
    Text(&'a str),
    /// Nothing: the column does not apply to this row.
    Empty,
}

/// Cells of a file as text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    /// Column names.
    pub columns: Vec<String>,
    /// Rows, each as long as the header, with the line on which it starts.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// A table of numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Column names.
    pub columns: Vec<String>,
    /// Rows, each as long as the header; NaN is missing.
    pub rows: Vec<Vec<f64>>,
}

impl Numbers {
    /// Index of the column of that name.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column == name)
    }
}

/// The unit at the end of a column name.
#[must_use]
pub fn unit(column: &str) -> Option<&str> {
    let (_, unit) = column.rsplit_once('_')?;
    UNITS.contains(&unit).then_some(unit)
}

/// Writes the header.
///
/// # Errors
/// What the stream reports.
pub fn write_header(out: &mut impl Write, columns: &[impl AsRef<str>]) -> io::Result<()> {
    let cells: Vec<Cell<'_>> = columns.iter().map(|column| Cell::Text(column.as_ref())).collect();
    write_row(out, &cells)
}

/// Writes a row.
///
/// # Errors
/// What the stream reports; `InvalidInput` for an infinite number.
pub fn write_row(out: &mut impl Write, cells: &[Cell<'_>]) -> io::Result<()> {
    for (i, cell) in cells.iter().enumerate() {
        if i > 0 {
            write!(out, ",")?;
        }
        match *cell {
            Cell::Number(value) => write_number(out, value)?,
            Cell::Integer(value) => write!(out, "{value}")?,
            // It would look like a blank line.
            Cell::Text("") if cells.len() == 1 => write!(out, "\"\"")?,
            Cell::Text(text) => write!(out, "{}", quoted(text))?,
            Cell::Empty => {}
        }
    }
    writeln!(out)
}

/// A text as a cell, quoted where it could be misread.
#[must_use]
pub fn quoted(text: &str) -> String {
    let odd = text.contains([',', ';', '\t', '"', '\n', '\r']) || text.trim() != text || text.starts_with('\u{feff}');
    if odd { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// Reads a file as text.
///
/// # Errors
/// No header, a quote that is never closed, rows of another length than the header, decimal commas between commas.
pub fn read_cells(name: &str, text: &str) -> Result<Cells, Error> {
    let text = without_mark(text);
    let header = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let outside = header.split('"').step_by(2);
    let count = |separator: char| outside.clone().map(|part| part.matches(separator).count()).sum::<usize>();
    let separator =
        [',', ';', '\t'].into_iter().max_by_key(|&separator| (count(separator), separator == ',')).unwrap_or(',');
    let mut records = records(name, text, separator as u8);
    let Some((_, header)) = records.next().transpose()? else {
        return Err(Place::file(name).syntax("the file is empty", "a header"));
    };
    let mut rows = Vec::new();
    for record in records {
        let (line, row) = record?;
        if row.len() != header.len() {
            let place = Place::file(name).at_line(line);
            let whole = |cell: &str| cell.parse::<i64>().is_ok();
            if row.len() > header.len() && separator == ',' && row.iter().all(whole) {
                let found = row.iter().take(2).collect::<Vec<_>>().join(",");
                return Err(Error::DecimalComma { place, found: shortened(&found) });
            }
            return Err(Error::RowLength { place, found: row.len(), expected: header.len() });
        }
        rows.push((line, row.iter().map(String::from).collect()));
    }
    let columns = header.iter().map(String::from).collect();
    Ok(Cells { columns, rows })
}

/// Reads a table of numbers.
///
/// # Errors
/// As [`read_cells`], and cells that are no numbers.
pub fn read_numbers(name: &str, text: &str) -> Result<Numbers, Error> {
    let cells = read_cells(name, text)?;
    let mut rows = Vec::with_capacity(cells.rows.len());
    for (line, row) in &cells.rows {
        let values = row.iter().zip(&cells.columns).map(|(cell, column)| {
            let place = || Place::file(name).at_line(*line).within(shortened(column));
            Ok(finite_or_missing(place, cell.trim())?.unwrap_or(f64::NAN))
        });
        rows.push(values.collect::<Result<Vec<f64>, Error>>()?);
    }
    Ok(Numbers { columns: cells.columns, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_error(text: &str, message: &str) {
        assert_eq!(read_numbers("a.csv", text).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn decimal_commas_are_recognised_whatever_separates_the_cells() {
        let says = |found: &str| format!("`{found}` has a decimal comma; expected a decimal point");
        check_error("time_s;x_m\n0,5;1\n", &format!("a.csv:2 (time_s): {}", says("0,5")));
        check_error("time_s,x_m\n0,5,1,25\n", &format!("a.csv:2: {}", says("0,5")));
        check_error("time_s,x_m\n\"0,5\",1\n", &format!("a.csv:2 (time_s): {}", says("0,5")));
        check_error("time_s\tx_m\n0\t1,5\n", &format!("a.csv:2 (x_m): {}", says("1,5")));
    }

    #[test]
    fn faults_are_named() {
        check_error("", "a.csv: the file is empty; expected a header");
        check_error("a,b\n1\n", "a.csv:2: 1 values; expected 2");
        check_error("a,b\n1,x\n", "a.csv:2 (b): `x`; expected a number");
        check_error("a,b\n\n1,1e999\n", "a.csv (b): value out of range at line 3");
        check_error("a,b\n1,\"x\n", "a.csv: ends inside a quoted cell at byte 9 (line 2)");
    }

    #[test]
    fn quoting_survives() {
        let columns = ["a,b", "say \"x\"", "line\nend", "tab\tbed", ""];
        let mut out = Vec::new();
        write_header(&mut out, &columns).unwrap();
        write_row(&mut out, &[Cell::Integer(-3), Cell::Number(1e-300), Cell::Empty, Cell::Text("x;y"), Cell::Text("")])
            .unwrap();
        let read = read_cells("a.csv", std::str::from_utf8(&out).unwrap()).unwrap();
        assert_eq!(read.columns, columns);
        assert_eq!(read.rows, [(3, ["-3", "1e-300", "", "x;y", ""].map(String::from).to_vec())]);
    }

    #[test]
    fn a_column_of_one_blank_name_is_no_blank_line() {
        let mut out = Vec::new();
        write_header(&mut out, &[""]).unwrap();
        assert_eq!(read_cells("a.csv", std::str::from_utf8(&out).unwrap()).unwrap().columns, [""]);
    }

    #[test]
    fn units_are_found_at_the_end() {
        assert_eq!(
            ["x_m", "time_s", "residual_px", "ess", "camera_1"].map(unit),
            [Some("m"), Some("s"), Some("px"), None, None]
        );
    }
}
