//! Points of C3D files as motions in the world, and points of motions as C3D files.
//!
//! Written files have the axes of TRC files.
//!
//! A C3D file has no times but a rate: frame 1 has time 0, and a file may begin later. Times of a motion that do not keep
//! within half a frame of a rate cannot be written; the first is rounded to a whole frame.

use super::content::{Content, Motion};
use super::error::MotionError;
use super::format::Format;
use crate::Error;
use sinew_formats::c3d::{self, C3d, C3dHeader};
use sinew_formats::point_table::PointTable;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::trc::trc_from_world;
use sinew_input::files;
use std::io;
use std::path::Path;

/// A motion as the bytes of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertedMotion {
    /// The file.
    pub bytes: Vec<u8>,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub rate_hz: f64,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// The file with all that it holds.
pub fn file(path: &Path) -> Result<C3d, sinew_results::Error> {
    Ok(c3d::read(&path.display().to_string(), &files::read_bytes(path, MAX_TEXT_BYTES)?)?)
}

/// Its points that are positions.
pub fn motion(file: &C3d) -> Motion {
    let (frames, markers) = (file.frames.len(), &file.header.markers);
    let (positions, others): (Vec<usize>, Vec<usize>) = {
        let are_positions = file.are_positions();
        (0..markers.len()).partition(|&marker| are_positions[marker])
    };
    let points = (0..frames).map(|frame| positions.iter().map(|&marker| file.point_in_world(frame, marker)).collect());
    let table = PointTable {
        names: positions.iter().map(|&marker| markers[marker].clone()).collect(),
        time_s: (0..frames).map(|frame| file.time_s(frame)).collect(),
        frames: points.collect(),
    };
    let mut warnings: Vec<String> = file.warnings.iter().map(ToString::to_string).collect();
    if let Some(&first) = others.first() {
        let (count, name) = (others.len(), &markers[first]);
        warnings.push(format!("{count} points are angles, forces or the like (first: `{name}`) and are left out"));
    }
    Motion {
        format: Format::C3d,
        rate_hz: file.header.rate_hz,
        start_frame: file.header.first_frame.into(),
        content: Content::Points(table),
        warnings,
    }
}

/// A C3D file as another one with all that it holds: points with residuals, analog channels, events, parameters.
///
/// # Errors
/// What the reader refuses, and what a file for Intel cannot hold.
pub fn rewritten_c3d(path: &Path) -> Result<ConvertedMotion, Error> {
    let file = file(path)?;
    let mut bytes = vec![];
    c3d::write_whole(&mut bytes, &file)
        .map_err(|refusal| MotionError::Unwritable { format: Format::C3d.name(), refusal })?;
    let warnings = file.warnings.iter().map(ToString::to_string).collect();
    Ok(ConvertedMotion { bytes, frames: file.frames.len(), rate_hz: file.header.rate_hz, warnings })
}

pub(super) fn write(out: &mut Vec<u8>, rate_hz: f64, points: &PointTable) -> io::Result<()> {
    let (rate_hz, first_frame) = numbering(rate_hz, &points.time_s)?;
    let header = C3dHeader { first_frame, ..C3dHeader::new(rate_hz, points.names.clone()) };
    let frames: Vec<Vec<_>> =
        points.frames.iter().map(|frame| frame.iter().map(|point| point.map(trc_from_world)).collect()).collect();
    c3d::write(out, &header, &frames)
}

/// Frames per second and number of the first frame: at the stated rate, or at that from first to last frame.
fn numbering(stated_hz: f64, time_s: &[f64]) -> io::Result<(f64, u32)> {
    let (start, end) = (time_s.first().copied().unwrap_or(0.0), time_s.last().copied().unwrap_or(0.0));
    let mean_hz = (time_s.len() as f64 - 1.0) / (end - start);
    let fits = |rate_hz: &f64| {
        let even = |(frame, time): (usize, &f64)| ((time - start) * rate_hz - frame as f64).abs() < 0.5;
        *rate_hz > 0.0 && rate_hz.is_finite() && time_s.iter().enumerate().all(even)
    };
    let invalid = |what: &str| io::Error::new(io::ErrorKind::InvalidInput, what);
    let rate_hz = [stated_hz, mean_hz].into_iter().find(fits);
    let rate_hz = rate_hz.ok_or_else(|| invalid("its frames have one rate, and the times of the motion have none"))?;
    let first = (start * rate_hz).round() + 1.0;
    if first < 1.0 || first > f64::from(u32::MAX) {
        return Err(invalid("its frames are numbered from time 0 on, and the motion begins elsewhere"));
    }
    Ok((rate_hz, first as u32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_numbered_by_their_times() {
        let check = |rate_hz, time_s: &[f64], expected: Option<(f64, u32)>| {
            assert_eq!(numbering(rate_hz, time_s).ok(), expected, "{time_s:?}");
        };
        check(60.0, &[0.0, 0.0167, 0.0333], Some((60.0, 1)));
        check(250.0, &[3.328, 3.332], Some((250.0, 833)));
        check(100.0, &[], Some((100.0, 1)));
        check(100.0, &[0.5], Some((100.0, 51)));
        // Rounded by a part in a thousand, which is a frame after a thousand.
        let long: Vec<f64> = (0..=2000).map(|frame| f64::from(frame) / 29.98).collect();
        let (rate_hz, first) = numbering(30.0, &long).unwrap();
        assert!((rate_hz - 29.98).abs() < 1e-9 && first == 1);
        check(0.0, &[0.5], None);
        check(10.0, &[0.0, 0.1, 0.4], None);
        check(10.0, &[-1.0, -0.9], None);
    }
}
