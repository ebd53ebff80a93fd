//! Reader of TRC files with the quirks of the programs that write them.

use super::table::{Header, Trc, TrcFrame, Units};
use crate::limits::{MAX_POINTS, check_count};
use crate::point_name::repeated;
use crate::row_time::RowTime;
use crate::source_text::{check_claim, finite, finite_or_missing, numbered_lines, shortened};
use crate::{Error, Place, Warning};

/// Reads a file.
///
/// # Errors
/// A header that is none, units other than m, cm and mm, rows longer than the header, cells that are no numbers, time
/// that goes back, and a frame count that the file cannot hold.
pub fn read(name: &str, text: &str) -> Result<Trc, Error> {
    let mut lines = numbered_lines(text).skip_while(|(_, line)| line.trim().is_empty()).peekable();
    let end = |what: &str| Place::file(name).syntax("the file ends", what);
    let (number, first) = lines.next().ok_or_else(|| end("a line `PathFileType …`"))?;
    if !first.trim_start().starts_with("PathFileType") {
        let place = Place::file(name).at_line(number);
        return Err(place.syntax(quote(first), "a line `PathFileType …`"));
    }
    let file_name = cells(first).get(3).copied().filter(|cell| !cell.is_empty()).unwrap_or(name).to_owned();
    let (_, keys) = lines.next().ok_or_else(|| end("the line `DataRate CameraRate …`"))?;
    let (values_line, values) = lines.next().ok_or_else(|| end("the values of DataRate, CameraRate, …"))?;
    let (_, names) = lines.next().ok_or_else(|| end("the line `Frame# Time …`"))?;

    let mut warnings = Vec::new();
    if !names.contains('\t') {
        warnings.push(Warning::SpacesForTabs { place: Place::file(name) });
    }
    let markers: Vec<String> = cells(names).iter().skip(2).filter(|cell| !cell.is_empty()).map(|&c| c.into()).collect();
    check_count(|| Place::file(name), markers.len(), "markers", MAX_POINTS)?;
    let fields = Fields { name, line: values_line, keys: cells(keys), values: cells(values) };
    let header = fields.header(file_name, markers, &mut warnings)?;
    let stated_frames = fields.count("NumFrames")?;
    let stated_markers = fields.count("NumMarkers")?;
    if let Some(claimed) = stated_frames {
        check_claim(name, claimed, "frames", text)?;
    }

    let mut frames = Vec::new();
    let mut time = RowTime::default();
    if let Some((_, labels)) = lines.peek()
        && let Some(label) = cells(labels).iter().find(|cell| !cell.is_empty())
        && label.parse::<f64>().is_err()
    {
        if *label != "X1" {
            warnings.push(Warning::OddLabels { place: Place::file(name), first: shortened(label) });
        }
        lines.next();
    }
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        check_size(name, (frames.len() + 1) * header.markers.len(), text)?;
        let frame = row(&Place::file(name).at_line(number), line, header.markers.len())?;
        time.check(name, frame.time_s)?;
        frames.push(frame);
    }

    let mut compare = |field, stated: Option<u64>, found: usize| {
        if let Some(stated) = stated.filter(|&stated| stated != found as u64) {
            let place = Place::file(name);
            warnings.push(Warning::CountDisagrees { place, field, stated, found: found as u64 });
        }
    };
    compare("NumFrames", stated_frames, frames.len());
    compare("NumMarkers", stated_markers, header.markers.len());
    let place = || Place::file(name);
    warnings.extend(repeated(&header.markers).map(|name| Warning::RepeatedMarker { place: place(), name }));
    warnings.extend(time.warning(name));
    Ok(Trc { header, frames, warnings })
}

/// Rows may stop early, so that few bytes could ask for much memory.
fn check_size(name: &str, points: usize, text: &str) -> Result<(), Error> {
    const ALWAYS: usize = 1_000_000;
    if points <= ALWAYS + 2 * text.len() {
        return Ok(());
    }
    let (claimed, bytes) = (points as u64, text.len() as u64);
    Err(Error::ImpossibleCount { place: Place::file(name), claimed, unit: "points", bytes })
}

/// Cells of a line: at tabs where there is one, else at blanks.
fn cells(line: &str) -> Vec<&str> {
    if line.contains('\t') { line.split('\t').map(str::trim).collect() } else { line.split_whitespace().collect() }
}

fn quote(line: &str) -> String {
    format!("`{}`", shortened(line))
}

/// Lines 2 and 3 of the header.
struct Fields<'a> {
    name: &'a str,
    line: usize,
    keys: Vec<&'a str>,
    values: Vec<&'a str>,
}

impl Fields<'_> {
    fn place(&self) -> Place {
        Place::file(self.name).at_line(self.line)
    }

    fn get(&self, key: &str) -> Option<&str> {
        let index = self.keys.iter().position(|found| found.eq_ignore_ascii_case(key))?;
        self.values.get(index).copied().filter(|value| !value.is_empty())
    }

    fn bad(&self, field: &str, found: &str, expected: &str) -> Error {
        self.place().bad_value(field, shortened(found), expected)
    }

    fn count(&self, key: &'static str) -> Result<Option<u64>, Error> {
        let Some(text) = self.get(key) else { return Ok(None) };
        let value = finite(|| self.place(), text)?;
        if value < 0.0 || value.fract() != 0.0 {
            return Err(self.bad(key, text, "a count"));
        }
        Ok(Some(value as u64))
    }

    fn header(&self, file_name: String, markers: Vec<String>, warnings: &mut Vec<Warning>) -> Result<Header, Error> {
        let mut assume = |field, value: &str| {
            warnings.push(Warning::Assumed { place: Place::file(self.name), field, value: value.into() });
        };
        let rate = self.get("DataRate").or_else(|| self.get("CameraRate"));
        let rate_hz = match rate {
            Some(text) => finite(|| self.place(), text)?,
            None => {
                return Err(self.place().lacks("DataRate"));
            }
        };
        if rate_hz <= 0.0 {
            return Err(self.bad("DataRate", rate.unwrap_or_default(), "positive"));
        }
        let units = match self.get("Units") {
            Some(text) => Units::named(text).ok_or_else(|| self.bad("Units", &text.to_lowercase(), "m, cm or mm"))?,
            None => {
                assume("Units", "m");
                Units::Metres
            }
        };
        let start_frame = match self.get("OrigDataStartFrame") {
            Some(text) => finite(|| self.place(), text)? as i64,
            None => 1,
        };
        Ok(Header { file_name, rate_hz, units, start_frame, markers })
    }
}

fn row(place: &Place, line: &str, markers: usize) -> Result<TrcFrame, Error> {
    let mut cells = cells(line);
    while cells.last().is_some_and(|cell| cell.is_empty()) {
        cells.pop();
    }
    let expected = 2 + 3 * markers;
    if cells.len() > expected {
        return Err(Error::RowLength { place: place.clone(), found: cells.len(), expected });
    }
    let cell = |index: usize| cells.get(index).copied().unwrap_or_default();
    let number = finite(|| place.clone(), cell(0))? as i64;
    let time_s = finite(|| place.clone(), cell(1))?;
    let mut points = Vec::with_capacity(markers);
    for marker in 0..markers {
        let mut point = [None; 3];
        for (axis, value) in point.iter_mut().enumerate() {
            *value = finite_or_missing(|| place.clone(), cell(2 + 3 * marker + axis))?;
        }
        points.push(match point {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        });
    }
    Ok(TrcFrame { number, time_s, points })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABBED: &str = "PathFileType\t4\t(X/Y/Z)\ta.trc\n\
        DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
        60\t60\t2\t2\tmm\t60\t1\t2\n\
        Frame#\tTime\tR Hip\t\t\tNose\t\t\n\
        \t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
        \n\
        1\t0.0\t1\t2\t3\t4\t5\t6\n\
        2\t0.5\t\t\t\t7\tNaN\t9\n";

    fn warnings(text: &str) -> Vec<String> {
        read("a.trc", text).unwrap().warnings.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn markers_have_a_bound() {
        let markers = |count: usize| {
            let names: String = (0..count).map(|k| format!("\tM{k}\t\t")).collect();
            format!("PathFileType\t4\nDataRate\tUnits\n60\tm\nFrame#\tTime{names}\n1\t0.0\t1\t2\t3\n")
        };
        assert_eq!(read("a.trc", &markers(10_000)).unwrap().header.markers.len(), 10_000);
        check_error(&markers(10_001), "a.trc: more than 10 000 markers, the most that are read");
    }

    fn check_error(text: &str, message: &str) {
        assert_eq!(read("a.trc", text).unwrap_err().to_string(), message);
    }

    #[test]
    fn blanks_and_nan_are_missing_and_names_keep_spaces() {
        let trc = read("a.trc", TABBED).unwrap();
        assert_eq!(trc.header.markers, ["R Hip", "Nose"]);
        assert_eq!(trc.frames[0].points, [Some([1.0, 2.0, 3.0]), Some([4.0, 5.0, 6.0])]);
        assert_eq!(trc.frames[1].points, [None, None]);
        assert_eq!(trc.warnings, []);
        assert_eq!(trc.point_in_world(0, 0), Some([0.003, 0.001, 0.002]));
    }

    #[test]
    fn line_ends_and_the_blank_line_do_not_matter() {
        let plain = read("a.trc", TABBED).unwrap();
        assert_eq!(read("a.trc", &TABBED.replace('\n', "\r\n")).unwrap(), plain);
        assert_eq!(read("a.trc", &TABBED.replace("Z2\n\n", "Z2\n")).unwrap(), plain);
        assert_eq!(read("a.trc", &format!("\u{feff}{TABBED}")).unwrap(), plain);
        assert_eq!(read("a.trc", &TABBED.replace("5\t6\n", "5\t6\t\t\n")).unwrap(), plain);
    }

    #[test]
    fn odd_files_are_read_with_a_warning() {
        assert_eq!(
            warnings(&TABBED.replace("60\t2\t2", "60\t99\t3")),
            ["a.trc: NumFrames says 99, the file holds 2", "a.trc: NumMarkers says 3, the file holds 2"]
        );
        assert_eq!(
            warnings(&TABBED.replace("X1\tY1", "X3\tY3")),
            ["a.trc: coordinate labels start with `X3` instead of `X1`; taken in order"]
        );
        let spaced = TABBED.replace("R Hip", "RHip").replace("\t\t\t7\tNaN", "NaN NaN NaN 7 NaN").replace('\t', "  ");
        assert_eq!(warnings(&spaced), ["a.trc: spaces instead of tabs; names cannot contain spaces then"]);
        assert_eq!(read("a.trc", &spaced).unwrap().frames[0].points[1], Some([4.0, 5.0, 6.0]));
        assert_eq!(
            warnings(&TABBED.replace("0.5", "0.0")),
            ["a.trc: 1 rows have the time of the row above (first: row 2)"]
        );
    }

    #[test]
    fn faults_are_named() {
        check_error("", "a.trc: the file ends; expected a line `PathFileType …`");
        check_error("x,y\n", "a.trc:1: `x,y`; expected a line `PathFileType …`");
        check_error(&TABBED.replace("\tmm\t", "\tinch\t"), "a.trc:3: Units = inch; must be m, cm or mm");
        check_error(&TABBED.replace("0.5", "-0.5"), "a.trc: time goes back at row 2: -0.5 after 0 s");
        check_error(&TABBED.replace("4\t5\t6", "4\t5\t6\t7"), "a.trc:7: 9 values; expected 8");
        check_error(&TABBED.replace("4\t5", "4\t5,5"), "a.trc:7: `5,5` has a decimal comma; expected a decimal point");
        check_error(&TABBED.replace("4\t5", "4\t1e999"), "a.trc: value out of range at line 7");
        check_error(
            &TABBED.replace("60\t2\t2", "60\t1000000000\t2"),
            "a.trc: file claims 10^9 frames, holds 234 bytes",
        );
    }
}
