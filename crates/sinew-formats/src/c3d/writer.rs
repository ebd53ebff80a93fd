//! Writer of C3D files: points as reals for Intel, frame by frame.

use super::recording::C3dHeader;
use super::source::BLOCK;
use super::written_parameters::section;
use crate::point_name::is_writable;
use std::io::{self, Write};

/// Longest name, bytes.
const NAME_BYTES: usize = 255;

/// Writes header and parameters. Their length does not depend on `frames`: write them with 0 first, and again at the
/// start of the file once the number is known.
///
/// # Errors
/// What the stream reports; `InvalidInput` for a name that is empty, starts or ends with a blank, holds a control
/// character or has more than 255 bytes, for more names than fit, and for a rate or frame numbers that do not fit.
pub fn write_header(out: &mut impl Write, header: &C3dHeader, frames: u32) -> io::Result<()> {
    for name in &header.markers {
        if !is_writable(name) || name.len() > NAME_BYTES {
            return Err(invalid(&format!("`{}` cannot be a name in a C3D file", name.escape_debug())));
        }
    }
    let points = u16::try_from(header.markers.len()).map_err(|_| invalid("more points than a C3D file can count"))?;
    let rate = header.rate_hz as f32;
    if !(rate.is_finite() && rate > 0.0) {
        return Err(invalid("a C3D file has a rate: it must be positive"));
    }
    let parameters = section(header, frames)?;
    let last = header.last_frame(frames)?;
    let short = |number: u32| number.try_into().unwrap_or(u16::MAX);
    let data_block = (2 + parameters.len() / BLOCK) as u16;
    let mut block = [0; BLOCK];
    // Words 1 to 10 but for the scale in 7 and 8: analog samples and largest gap are 0, samples of a channel 1.
    let words = [0x5002, points, 0, short(header.first_frame), short(last), 0, 0, 0, data_block, 1];
    for (place, word) in block.as_chunks_mut::<2>().0.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    block[12..16].copy_from_slice(&(-1.0_f32).to_le_bytes());
    block[20..24].copy_from_slice(&rate.to_le_bytes());
    out.write_all(&block)?;
    out.write_all(&parameters)
}

/// Writes a frame, positions in the units and axes of the file.
///
/// # Errors
/// What the stream reports; `InvalidInput` for a number that four bytes cannot hold.
pub fn write_frame(out: &mut impl Write, points: &[Option<[f64; 3]>]) -> io::Result<()> {
    for point in points {
        let [x, y, z] = point.unwrap_or_default().map(|value| value as f32);
        if ![x, y, z].iter().all(|value| value.is_finite()) {
            return Err(invalid("a number that is too large, or none, cannot be written"));
        }
        for value in [x, y, z, if point.is_some() { 0.0 } else { -1.0 }] {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(())
}

/// Fills the last block behind the frames.
///
/// # Errors
/// What the stream reports.
pub fn write_end(out: &mut impl Write, header: &C3dHeader, frames: u32) -> io::Result<()> {
    let written = 16 * header.markers.len() * frames as usize;
    out.write_all(&[0; BLOCK][..written.next_multiple_of(BLOCK) - written])
}

/// Writes a whole file.
///
/// # Errors
/// As [`write_header`] and [`write_frame`].
pub fn write(out: &mut impl Write, header: &C3dHeader, frames: &[Vec<Option<[f64; 3]>>]) -> io::Result<()> {
    let count = u32::try_from(frames.len()).map_err(|_| invalid("more frames than a header can count"))?;
    write_header(out, header, count)?;
    frames.iter().try_for_each(|points| write_frame(out, points))?;
    write_end(out, header, count)
}

pub(super) fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &[&str]) -> C3dHeader {
        C3dHeader::new(59.94, names.iter().map(|&name| name.into()).collect())
    }

    fn written(header: &C3dHeader, frames: u32) -> Vec<u8> {
        let mut out = Vec::new();
        write_header(&mut out, header, frames).unwrap();
        out
    }

    #[test]
    fn the_header_can_be_written_over_itself() {
        let header = header(&["A"]);
        assert_eq!(written(&header, 0).len(), written(&header, u32::MAX - 1).len());
        assert_eq!(written(&header, 7).len() % BLOCK, 0);
    }

    #[test]
    fn points_that_no_reader_could_return_are_refused() {
        let refused = |header: &C3dHeader| write_header(&mut Vec::new(), header, 0).is_err();
        for name in ["", " A", "A\tB", &"a".repeat(256)] {
            assert!(refused(&header(&[name])), "{name:?}");
        }
        assert!(refused(&C3dHeader { rate_hz: 0.0, ..header(&["A"]) }));
        assert!(refused(&C3dHeader { first_frame: 0, ..header(&["A"]) }));
        assert!(refused(&header(&vec!["a"; 65_536])));
        assert!(refused(&header(&vec!["a"; 65_535])), "130 kB of parameters are not enough");
        assert!(!refused(&header(&vec![&"a".repeat(255)[..]; 400])));
        assert!(!refused(&header(&vec!["ten bytes!"; 11_000])));
        for value in [f64::INFINITY, f64::NAN, 1e39] {
            assert!(write_frame(&mut Vec::new(), &[Some([value, 0.0, 0.0])]).is_err());
        }
    }
}
