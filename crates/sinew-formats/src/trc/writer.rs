//! Writer of TRC files, frame by frame.

use super::table::{Header, Trc};
use crate::numbers::{write_number, write_plain};
use crate::point_name::is_writable;
use std::io::{self, Write};

/// Writes the header. Its length does not depend on `frames`: write it with 0 first, and again at the start of the file
/// once the number is known.
///
/// # Errors
/// What the stream reports; `InvalidInput` for a name that is empty, starts or ends with a blank or holds a control
/// character, and for an infinite rate.
pub fn write_header(out: &mut impl Write, header: &Header, frames: u32) -> io::Result<()> {
    for name in header.markers.iter().chain([&header.file_name]) {
        check_name(name)?;
    }
    writeln!(out, "PathFileType\t4\t(X/Y/Z)\t{}", header.file_name)?;
    writeln!(
        out,
        "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames"
    )?;
    write_plain(out, header.rate_hz)?;
    write!(out, "\t")?;
    write_plain(out, header.rate_hz)?;
    write!(out, "\t{frames:010}\t{}\t{}\t", header.markers.len(), header.units.symbol())?;
    write_plain(out, header.rate_hz)?;
    writeln!(out, "\t{}\t{frames:010}", header.start_frame)?;
    write!(out, "Frame#\tTime")?;
    for name in &header.markers {
        write!(out, "\t{name}\t\t")?;
    }
    write!(out, "\n\t")?;
    for i in 1..=header.markers.len() {
        write!(out, "\tX{i}\tY{i}\tZ{i}")?;
    }
    write!(out, "\n\n")
}

/// Writes a row; a missing point becomes three times `NaN`.
///
/// # Errors
/// What the stream reports; `InvalidInput` for an infinite number.
pub fn write_frame(out: &mut impl Write, number: i64, time_s: f64, points: &[Option<[f64; 3]>]) -> io::Result<()> {
    write!(out, "{number}\t")?;
    write_number(out, time_s)?;
    for point in points {
        for value in point.unwrap_or([f64::NAN; 3]) {
            write!(out, "\t")?;
            write_number(out, value)?;
        }
    }
    writeln!(out)
}

/// Writes a whole file.
///
/// # Errors
/// As [`write_header`] and [`write_frame`].
pub fn write(out: &mut impl Write, trc: &Trc) -> io::Result<()> {
    let frames = u32::try_from(trc.frames.len()).map_err(|_| invalid("more frames than a header can count"))?;
    write_header(out, &trc.header, frames)?;
    trc.frames.iter().try_for_each(|frame| write_frame(out, frame.number, frame.time_s, &frame.points))
}

fn check_name(name: &str) -> io::Result<()> {
    if !is_writable(name) {
        return Err(invalid(&format!("`{}` cannot be a name in a TRC file", name.escape_debug())));
    }
    Ok(())
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &[&str]) -> Header {
        Header::new("markers.trc", 59.94, names.iter().map(|&name| name.into()).collect())
    }

    #[test]
    fn the_file_is_as_documented() {
        let mut out = Vec::new();
        write_header(&mut out, &header(&["R Hip", "Nose"]), 1).unwrap();
        write_frame(&mut out, 1, 0.5, &[Some([0.1, -2.0, 1e-7]), None]).unwrap();
        let expected = "PathFileType\t4\t(X/Y/Z)\tmarkers.trc\n\
            DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
            59.94\t59.94\t0000000001\t2\tm\t59.94\t1\t0000000001\n\
            Frame#\tTime\tR Hip\t\t\tNose\t\t\n\
            \t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
            \n\
            1\t0.5\t0.1\t-2.0\t1e-7\tNaN\tNaN\tNaN\n";
        assert_eq!(String::from_utf8(out).unwrap(), expected);
    }

    #[test]
    fn the_header_can_be_written_over_itself() {
        let length = |frames| {
            let mut out = Vec::new();
            write_header(&mut out, &header(&["A"]), frames).unwrap();
            out.len()
        };
        assert_eq!(length(0), length(u32::MAX));
    }

    #[test]
    fn what_cannot_be_read_back_is_refused() {
        for name in ["", " A", "A\tB"] {
            assert!(write_header(&mut Vec::new(), &header(&[name]), 0).is_err(), "{name:?}");
        }
        assert!(write_frame(&mut Vec::new(), 1, 0.0, &[Some([f64::INFINITY, 0.0, 0.0])]).is_err());
    }
}
