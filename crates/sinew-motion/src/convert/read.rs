//! Reads a motion file by its extension.

use super::acclaim::skeleton_of;
use super::c3d_points;
use super::content::{Content, Motion, rate_of};
use super::error::MotionError;
use super::format::Format;
use crate::Error;
use sinew_formats::mot::{self, Mot};
use sinew_formats::point_table::{self, PointTable};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{amc, asf, bvh, tidy_csv, trc};
use sinew_input::files;
use sinew_input::flag::typed;
use sinew_results::people::refuse_several;
use sinew_results::result_table::{MOTION_FILES, ResultTable};
use std::path::Path;

/// Rate of the CMU recordings, of which most AMC files come.
pub(super) const AMC_RATE_HZ: f64 = 120.0;

/// Reads a motion.
///
/// `skeleton` is the ASF file of an AMC file; `fps` the rate of files that have none.
///
/// # Errors
/// What the readers refuse; an AMC file without its skeleton; a table with neither points nor coordinates.
pub fn read(path: &Path, skeleton: Option<&Path>, fps: Option<f64>) -> Result<Motion, Error> {
    refuse_several(path).map_err(sinew_results::Error::from)?;
    let format = Format::of(path)?;
    if format != Format::Amc && skeleton.is_some() {
        return Err(MotionError::NeedlessSkeleton { path: path.to_owned() }.into());
    }
    let text = || files::read_text(path, MAX_TEXT_BYTES);
    let name = path.display().to_string();
    match format {
        Format::Trc => from_trc(trc::read(&name, &text()?)?),
        Format::C3d => Ok(c3d_points::motion(&c3d_points::file(path)?)),
        Format::Mot => from_mot(mot::read(&name, &text()?)?),
        Format::Csv => from_csv(&name, &text()?),
        Format::Bvh => {
            let bvh = bvh::read(&name, &text()?)?;
            let mut warnings: Vec<String> = bvh.warnings.iter().map(ToString::to_string).collect();
            let rate_hz = rate(bvh.frame_time_s.recip());
            let motion =
                Motion { format, rate_hz, start_frame: 1, content: Content::Skeleton(bvh), warnings: Vec::new() };
            warnings.extend(odd_size(&motion));
            Ok(Motion { warnings, ..motion })
        }
        Format::Glb => Err(MotionError::WriteOnly { path: path.to_owned() }.into()),
        Format::Amc => {
            let text = text()?;
            let Some(skeleton) = skeleton else {
                return Err(MotionError::NoSkeleton { file: name }.into());
            };
            let asf = asf::read(&skeleton.display().to_string(), &files::read_text(skeleton, MAX_TEXT_BYTES)?)?;
            let amc = amc::read(&name, &text, &asf)?;
            let rate_hz = fps.unwrap_or(AMC_RATE_HZ);
            let mut warnings: Vec<String> = amc.warnings.iter().map(ToString::to_string).collect();
            if fps.is_none() {
                warnings.push(format!(
                    "{name}: AMC files state no rate; {AMC_RATE_HZ} frames per second assumed (`sinew convert {}` sets another)",
                    typed("fps")
                ));
            }
            let start_frame = amc.frames.first().map_or(1, |frame| i64::try_from(frame.number).unwrap_or(1));
            let content = Content::Skeleton(skeleton_of(&asf, &amc, rate_hz));
            Ok(Motion { format, rate_hz, start_frame, content, warnings })
        }
    }
}

/// A rate from a duration written with few digits.
fn rate(rate_hz: f64) -> f64 {
    if !rate_hz.is_finite() {
        0.0
    } else if (rate_hz - rate_hz.round()).abs() < 1e-4 * rate_hz {
        rate_hz.round()
    } else {
        rate_hz
    }
}

fn from_trc(trc: trc::Trc) -> Result<Motion, Error> {
    let points = (0..trc.frames.len())
        .map(|frame| (0..trc.header.markers.len()).map(|marker| trc.point_in_world(frame, marker)).collect());
    let table = PointTable {
        names: trc.header.markers.clone(),
        time_s: trc.frames.iter().map(|frame| frame.time_s).collect(),
        frames: points.collect(),
    };
    Ok(Motion {
        format: Format::Trc,
        rate_hz: trc.header.rate_hz,
        start_frame: trc.header.start_frame,
        content: Content::Points(table),
        warnings: trc.warnings.iter().map(ToString::to_string).collect(),
    })
}

fn from_mot(mut mot: Mot) -> Result<Motion, Error> {
    if !mot.in_degrees {
        for row in &mut mot.rows {
            for (value, column) in row.iter_mut().zip(&mot.columns).filter(|(_, column)| !is_length(column)) {
                debug_assert!(!column.is_empty());
                *value = value.to_degrees();
            }
        }
        mot.in_degrees = true;
    }
    Ok(Motion {
        format: Format::Mot,
        rate_hz: rate_of(&mot.time_s),
        start_frame: 1,
        warnings: mot.warnings.iter().map(ToString::to_string).collect(),
        content: Content::Coordinates(mot),
    })
}

/// Whether a coordinate of OpenSim is a length, by its name.
pub(super) fn is_length(column: &str) -> bool {
    ["_tx", "_ty", "_tz"].iter().any(|end| column.ends_with(end))
}

fn from_csv(name: &str, text: &str) -> Result<Motion, Error> {
    if let Some(table) = ResultTable::of(text) {
        return Err(
            MotionError::NoMotion { file: name.into(), table: table.describe().into(), motions: MOTION_FILES }.into()
        );
    }
    let table = tidy_csv::read_numbers(name, text)?;
    if table.columns.iter().any(|column| column.ends_with("_x_m")) {
        let points = point_table::from_numbers(name, &table)?;
        let rate_hz = rate_of(&points.time_s);
        return Ok(Motion {
            format: Format::Csv,
            rate_hz,
            start_frame: 1,
            content: Content::Points(points),
            warnings: Vec::new(),
        });
    }
    let Some(time) = table.column("time_s") else {
        return Err(MotionError::NoTimes { file: name.into() }.into());
    };
    let mut columns = Vec::new();
    let mut taken = Vec::new();
    for (index, column) in table.columns.iter().enumerate().filter(|(index, _)| *index != time) {
        let (title, factor) = match tidy_csv::unit(column) {
            Some("deg") => (column.trim_end_matches("_deg"), 1.0),
            Some("rad") => (column.trim_end_matches("_rad"), 1f64.to_degrees()),
            Some("m") => (column.trim_end_matches("_m"), 1.0),
            _ => continue,
        };
        columns.push(title.to_owned());
        taken.push((index, factor));
    }
    if columns.is_empty() {
        return Err(MotionError::NoColumns { file: name.into() }.into());
    }
    let time_s: Vec<f64> = table.rows.iter().map(|row| row[time]).collect();
    let rows =
        table.rows.iter().map(|row| taken.iter().map(|&(index, factor)| factor * row[index]).collect()).collect();
    let mot = Mot { title: "Coordinates".into(), in_degrees: true, columns, rows, warnings: Vec::new(), time_s };
    Ok(Motion {
        format: Format::Csv,
        rate_hz: rate_of(&mot.time_s),
        start_frame: 1,
        content: Content::Coordinates(mot),
        warnings: Vec::new(),
    })
}

/// Extents of a skeleton that are plausible in metres.
const PLAUSIBLE_M: std::ops::Range<f64> = 0.4..3.0;

fn odd_size(motion: &Motion) -> Option<String> {
    let points = motion.points()?;
    let first = points.frames.first()?;
    let extent = |axis: usize| {
        let values = first.iter().flatten().map(|point| point[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    let size = (0..3).map(extent).fold(0.0, f64::max);
    (!PLAUSIBLE_M.contains(&size)).then(|| {
        format!(
            "the skeleton is {size:.1} units large in its first frame; BVH files state no unit, it is taken as metres"
        )
    })
}
