//! MOT: coordinates over time, as OpenSim reads them.
//!
//! ```text
//! Coordinates
//! version=1
//! nRows=0000000100
//! nColumns=3
//! inDegrees=yes
//!
//! endheader
//! time  pelvis_tilt  pelvis_tx
//! 0.0  1.5  0.02
//! ```
//!
//! Tabs in the table; rotations in degrees where the header says so, translations in metres. The reader takes any header
//! lines before `endheader`, blanks for tabs, CRLF, counts that disagree (a warning) and `NaN` (missing, kept as NaN), so
//! that `.sto` files are read too. The number of rows is written with ten digits, so that the header can be written
//! again over itself at the end.
//!
//! ```
//! use sinew_formats::mot;
//! let columns = vec!["hip_flexion_r".to_string()];
//! let mut file = Vec::new();
//! mot::write_header(&mut file, "Coordinates", &columns, 1)?;
//! mot::write_row(&mut file, 0.5, &[30.0])?;
//! let read = mot::read("angles.mot", std::str::from_utf8(&file).unwrap())?;
//! assert_eq!((read.time_s[0], read.rows[0][0]), (0.5, 30.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::numbers::write_number;
use crate::row_time::RowTime;
use crate::source_text::{check_claim, finite, finite_or_missing, numbered_lines, shortened};
use crate::{Error, Place, Warning};
use std::io::{self, Write};

/// A file.
#[derive(Clone, Debug, PartialEq)]
pub struct Mot {
    /// First line.
    pub title: String,
    /// Whether rotations are in degrees.
    pub in_degrees: bool,
    /// Names of the columns after `time`.
    pub columns: Vec<String>,
    /// Time of each row, seconds.
    pub time_s: Vec<f64>,
    /// Values of each row; NaN is missing.
    pub rows: Vec<Vec<f64>>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

/// Reads a file.
///
/// # Errors
/// No `endheader`, a table that does not start with `time`, rows of another length, cells that are no numbers, time that
/// goes back, a row count that the file cannot hold.
pub fn read(name: &str, text: &str) -> Result<Mot, Error> {
    let place = |line: usize| Place::file(name).at_line(line);
    let mut lines = numbered_lines(text);
    let header = HeaderLines::read(name, &mut lines)?;
    if let Some(claimed) = header.rows {
        check_claim(name, claimed, "rows", text)?;
    }
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let (number, line) = lines.next().unwrap_or((0, ""));
    let names = cells(line);
    let Some((first, columns)) = names.split_first().filter(|(first, _)| first.eq_ignore_ascii_case("time")) else {
        return Err(place(number).syntax(format!("`{}`", shortened(line)), "a table that starts with `time`"));
    };
    let mut mot = Mot {
        title: header.title.unwrap_or_default(),
        in_degrees: header.in_degrees.unwrap_or(false),
        columns: columns.iter().map(|&column| column.into()).collect(),
        time_s: Vec::new(),
        rows: Vec::new(),
        warnings: Vec::new(),
    };
    if header.in_degrees.is_none() {
        let (field, value) = ("inDegrees", "no".to_owned());
        mot.warnings.push(Warning::Assumed { place: Place::file(name), field, value });
    }
    let mut time = RowTime::default();
    for (number, line) in lines {
        let values = cells(line);
        if values.len() != names.len() {
            let (found, expected) = (values.len(), names.len());
            return Err(Error::RowLength { place: place(number), found, expected });
        }
        let at = || place(number);
        let time_s = finite(at, values.first().copied().unwrap_or(first))?;
        time.check(name, time_s)?;
        let row = values.iter().skip(1).map(|cell| Ok(finite_or_missing(at, cell)?.unwrap_or(f64::NAN)));
        mot.rows.push(row.collect::<Result<_, Error>>()?);
        mot.time_s.push(time_s);
    }
    for (field, stated, found) in
        [("nRows", header.rows, mot.rows.len()), ("nColumns", header.columns, mot.columns.len() + 1)]
    {
        if let Some(stated) = stated.filter(|&stated| stated != found as u64) {
            let place = Place::file(name);
            mot.warnings.push(Warning::CountDisagrees { place, field, stated, found: found as u64 });
        }
    }
    mot.warnings.extend(time.warning(name));
    Ok(mot)
}

#[derive(Default)]
struct HeaderLines {
    title: Option<String>,
    in_degrees: Option<bool>,
    rows: Option<u64>,
    columns: Option<u64>,
}

impl HeaderLines {
    /// Takes the lines up to `endheader`.
    fn read<'a>(name: &str, lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<Self, Error> {
        let mut header = Self::default();
        for (number, line) in lines {
            if line.trim().eq_ignore_ascii_case("endheader") {
                return Ok(header);
            }
            header.take(|| Place::file(name).at_line(number), line)?;
        }
        Err(Place::file(name).syntax("the file ends", "a line `endheader`"))
    }

    fn take(&mut self, place: impl Fn() -> Place, line: &str) -> Result<(), Error> {
        let (key, value) = match line.split_once('=') {
            Some((key, value)) => (key.trim(), value.trim()),
            None => {
                if self.title.is_none() && !line.trim().is_empty() {
                    self.title = Some(line.trim().into());
                }
                return Ok(());
            }
        };
        let bad = |expected: &str| place().bad_value(shortened(key), shortened(value), expected);
        match key.to_ascii_lowercase().as_str() {
            "nrows" | "datarows" => self.rows = Some(value.parse().map_err(|_| bad("a count"))?),
            "ncolumns" | "datacolumns" => self.columns = Some(value.parse().map_err(|_| bad("a count"))?),
            "indegrees" => {
                self.in_degrees = Some(match value.to_ascii_lowercase().as_str() {
                    "yes" => true,
                    "no" => false,
                    _ => return Err(bad("yes or no")),
                });
            }
            _ => {}
        }
        Ok(())
    }
}

fn cells(line: &str) -> Vec<&str> {
    let line = line.trim();
    if line.contains('\t') { line.split('\t').map(str::trim).collect() } else { line.split_whitespace().collect() }
}

/// Writes the header and the names of the columns; rotations are then in degrees. Its length does not depend on `rows`:
/// write it with 0 first, and again at the start of the file once the number is known.
///
/// # Errors
/// What the stream reports; `InvalidInput` for a name that is empty or holds a blank.
pub fn write_header(out: &mut impl Write, title: &str, columns: &[String], rows: u32) -> io::Result<()> {
    let odd_title = title.trim() != title || title.is_empty() || title.contains(['=', '\n', '\r']);
    let odd = columns.iter().find(|name| name.is_empty() || name.contains(char::is_whitespace));
    if odd_title || odd.is_some() || title.eq_ignore_ascii_case("endheader") {
        let what = format!("`{}` cannot be a name in a MOT file", odd.map_or(title, String::as_str).escape_debug());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    write!(out, "{title}\nversion=1\nnRows={rows:010}\nnColumns={}\n", columns.len() + 1)?;
    write!(out, "inDegrees=yes\n\nendheader\ntime")?;
    columns.iter().try_for_each(|name| write!(out, "\t{name}"))?;
    writeln!(out)
}

/// Writes a row.
///
/// # Errors
/// What the stream reports; `InvalidInput` for an infinite number.
pub fn write_row(out: &mut impl Write, time_s: f64, values: &[f64]) -> io::Result<()> {
    write_number(out, time_s)?;
    for &value in values {
        write!(out, "\t")?;
        write_number(out, value)?;
    }
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nUnits are S.I. units\n\
        If the header above contains a line with 'inDegrees', …\n\nendheader\ntime\ta\tb\n\
              0.0\t      1.5\t     -2\n 0.5\t nan\t 3\n";

    fn check_error(text: &str, message: &str) {
        assert_eq!(read("a.mot", text).unwrap_err().to_string(), message);
    }

    #[test]
    fn a_file_of_another_program_is_read() {
        let mot = read("a.mot", FILE).unwrap();
        assert_eq!((mot.title.as_str(), mot.in_degrees), ("Coordinates", true));
        assert_eq!(mot.columns, ["a", "b"]);
        assert_eq!(mot.time_s, [0.0, 0.5]);
        assert_eq!(mot.rows[0], [1.5, -2.0]);
        assert!(mot.rows[1][0].is_nan());
        assert_eq!(mot.warnings, []);
        let spaced = read("a.mot", &FILE.replace('\t', " ").replace('\n', "\r\n")).unwrap();
        assert_eq!((spaced.columns, &spaced.rows[0]), (mot.columns, &mot.rows[0]));
    }

    #[test]
    fn faults_are_named() {
        check_error("Coordinates\nnRows=2\n", "a.mot: the file ends; expected a line `endheader`");
        check_error(
            &FILE.replace("time", "t"),
            "a.mot:11: `t\ta\tb`; expected a table that starts with `time`".replace('\t', " ").as_str(),
        );
        check_error(&FILE.replace("     -2", "-2\t4"), "a.mot:12: 4 values; expected 3");
        check_error(&FILE.replace("nRows=2", "nRows=two"), "a.mot:3: nRows = two; must be a count");
        check_error(&FILE.replace(" 0.5", "-0.5"), "a.mot: time goes back at row 2: -0.5 after 0 s");
        let warnings = read("a.mot", &FILE.replace("nRows=2", "nRows=3")).unwrap().warnings;
        assert_eq!(warnings[0].to_string(), "a.mot: nRows says 3, the file holds 2");
    }

    #[test]
    fn the_file_is_as_documented() {
        let mut out = Vec::new();
        write_header(&mut out, "Coordinates", &["pelvis_tx".into()], 7).unwrap();
        write_row(&mut out, 0.25, &[-1e-9]).unwrap();
        let expected = "Coordinates\nversion=1\nnRows=0000000007\nnColumns=2\ninDegrees=yes\n\nendheader\n\
            time\tpelvis_tx\n0.25\t-1e-9\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
        assert!(write_header(&mut Vec::new(), "Coordinates", &["a b".into()], 0).is_err());
    }
}
