//! A result beside a reference: markers or joint centres of a laboratory, or angles of another program.
//!
//! 1. Points (or angles) that mean the same are found by name or by a mapping (`matching`).
//! 2. The reference is read between its frames by interpolation, never beyond its ends or over gaps (`sampled`).
//! 3. Its clock and its world are aligned with the result's, with standard deviations (`points`, `angles`).
//! 4. What remains are differences: bias, spread and limits of agreement of each, and how often the result's intervals hold the reference (`agreement`).
//!
//! A reference has errors of its own, and a laboratory's joint centre need not be where ours is: a bias of a joint is both together, and an interval that does not hold the reference may still hold the joint.

mod agreement;
mod angles;
mod clock;
mod clusters;
pub(crate) mod error;
mod estimates;
mod matching;
mod outcome;
mod picture;
mod points;
mod rigid;
mod sampled;
mod tables;
mod worth;

pub use agreement::{Agreement, AgreementLimits, LEVELS, Pair, agreement, limits_of_agreement};
pub use clock::RivalOffset;
pub use error::CompareError;
pub use outcome::{AlignedWorlds, Alignment, ComparedSeries, Comparison, PartsToAlign};
pub use rigid::Similarity;
pub use tables::{as_json, comparison_table};

use crate::Error;
use estimates::Estimates;
use matching::{MatchedPoint, matched, unmatched};
use picture::bland_altman;
use points::{LEAST_FRAMES, Unaligned};
use sampled::Sampled;
use sinew::angles::circle::{TURN_DEG, turns};
use sinew::files::read_text;
use sinew_formats::point_mapping::{self, MappedPoint};
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_motion::convert::{Content, Format, Motion, read};
use sinew_results::people::refuse_several;
use sinew_results::{COMPARISON_NAMES, without_summary};
use std::path::{Path, PathBuf};

/// What to compare with, and how.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComparisonRequest {
    /// Points (.c3d, .trc, .csv, .bvh) or angles (.mot).
    pub reference: PathBuf,
    /// File that says which of its points are which of ours.
    pub names: Option<PathBuf>,
    /// What is aligned; scale counts with space only.
    pub parts: PartsToAlign,
}

/// Points that a turn of a world takes.
const LEAST_POINTS: usize = 3;

/// Compares.
///
/// # Errors
/// A folder without results, a reference that cannot be read, names without a counterpart, and recordings that do not overlap.
pub fn compare(folder: &Path, request: &ComparisonRequest) -> Result<Comparison, Error> {
    refuse_several(folder).map_err(sinew::Error::from)?;
    if !folder.join("summary.json").exists() {
        return Err(without_summary(folder).into());
    }
    let mapping = request.names.as_deref().map(mapping).transpose()?;
    let motion = read(&request.reference, None, None)?;
    let found = match &motion.content {
        Content::Coordinates(_) => with_angles(folder, request, &motion, mapping.as_deref())?,
        Content::Points(_) | Content::Skeleton(_) => with_points(folder, request, &motion, mapping.as_deref())?,
    };
    Ok(found)
}

fn mapping(path: &Path) -> Result<Vec<MappedPoint>, Error> {
    Ok(point_mapping::read(&path.display().to_string(), &read_text(path, MAX_CONFIG_BYTES)?)?)
}

/// Refuses a reference without times that rise.
fn rising(times_s: &[f64], request: &ComparisonRequest) -> Result<(), CompareError> {
    let is_rising = times_s.iter().all(|time| time.is_finite()) && times_s.windows(2).all(|pair| pair[0] < pair[1]);
    if is_rising { Ok(()) } else { Err(CompareError::Times(request.reference.clone())) }
}

/// Keeps of the estimates what has a counterpart, in the order of the matches.
fn kept<const D: usize>(estimates: Estimates<D>, matches: &[MatchedPoint]) -> Estimates<D> {
    Estimates {
        names: matches.iter().map(|one| estimates.names[one.ours].clone()).collect(),
        series: matches.iter().map(|one| estimates.series[one.ours].clone()).collect(),
        ..estimates
    }
}

fn refused(why: Unaligned, request: &ComparisonRequest) -> CompareError {
    let reference = request.reference.clone();
    match why {
        Unaligned::Frames(found) => CompareError::TooFewFrames { reference, found, needed: LEAST_FRAMES },
        Unaligned::OnALine => CompareError::OnALine(reference),
    }
}

/// Refuses fewer names than are needed.
fn enough(
    matches: &[MatchedPoint],
    names: &[String],
    what: &'static str,
    needed: usize,
    request: &ComparisonRequest,
) -> Result<(), CompareError> {
    let (reference, found) = (request.reference.clone(), matches.len());
    let too_few = || CompareError::TooFewNames { reference, what, found, needed, names: names.to_vec() };
    if found < needed { Err(too_few()) } else { Ok(()) }
}

fn with_points(
    folder: &Path,
    request: &ComparisonRequest,
    motion: &Motion,
    mapping: Option<&[MappedPoint]>,
) -> Result<Comparison, Error> {
    let mut table = motion.points().unwrap_or_default();
    rising(&table.time_s, request)?;
    if table.frames.is_empty() {
        return Err(refused(Unaligned::Frames(0), request).into());
    }
    let ours = estimates::points(folder)?;
    let matches = matched(&ours.names, &table.names, mapping)?;
    enough(&matches, &table.names, "points", if request.parts.space { LEAST_POINTS } else { 1 }, request)?;
    let middle = |frame: &Vec<Option<[f64; 3]>>, from: &[usize]| {
        let points = from.iter().map(|at| frame[*at]).collect::<Option<Vec<[f64; 3]>>>()?;
        let mean = |axis: usize| points.iter().map(|point| point[axis]).sum::<f64>() / points.len() as f64;
        Some([0, 1, 2].map(mean))
    };
    let zeros = if matches!(motion.format, Format::Trc | Format::C3d) { without_zeros(&mut table.frames) } else { 0 };
    let channels = matches.iter().map(|one| table.frames.iter().map(|frame| middle(frame, &one.reference)).collect());
    let reference = Sampled::new(table.time_s, channels.collect());
    let left = unmatched(&ours.names, &table.names, &matches);
    let ours = kept(ours, &matches);
    let (alignment, series) = points::aligned(&ours, &reference, request.parts).map_err(|why| refused(why, request))?;
    let mut warnings = [motion.warnings.clone(), alignment_warnings(&alignment)].concat();
    if zeros > 0 {
        warnings.push(format!(
            "{zeros} places of the reference are exactly 0 0 0: taken for gaps, as laboratories write them"
        ));
    }
    Ok(Comparison::new(alignment, series, left, warnings))
}

/// Makes gaps of places that are exactly the origin, which no marker is, and says how many there were.
fn without_zeros(frames: &mut [Vec<Option<[f64; 3]>>]) -> usize {
    let zeros = frames.iter_mut().flatten().filter(|point| **point == Some([0.0; 3]));
    zeros.map(|point| *point = None).count()
}

fn with_angles(
    folder: &Path,
    request: &ComparisonRequest,
    motion: &Motion,
    mapping: Option<&[MappedPoint]>,
) -> Result<Comparison, Error> {
    let Content::Coordinates(table) = &motion.content else {
        return Err(refused(Unaligned::Frames(0), request).into());
    };
    if request.parts.scale {
        return Err(CompareError::SpaceOfAngles(request.reference.clone()).into());
    }
    rising(&table.time_s, request)?;
    let ours = estimates::angles(folder)?;
    let matches = matched(&ours.names, &table.columns, mapping)?;
    enough(&matches, &table.columns, "angles", 1, request)?;
    let channels = matches.iter().map(|one| channel(table.rows.iter().map(|row| row[one.reference[0]])));
    let reference = Sampled::new(table.time_s.clone(), channels.collect());
    let left = unmatched(&ours.names, &table.columns, &matches);
    let ours = kept(ours, &matches);
    let parts = PartsToAlign { space: false, ..request.parts };
    let (alignment, series) = angles::aligned(&ours, &reference, parts).map_err(|why| refused(why, request))?;
    let warnings = [motion.warnings.clone(), alignment_warnings(&alignment)].concat();
    Ok(Comparison::new(alignment, series, left, warnings))
}

/// An angle of the reference, frame by frame, degrees: continuous, so that it can be read between frames.
fn channel(values: impl Iterator<Item = f64> + Clone) -> Vec<Option<[f64; 1]>> {
    let continuous = values.clone().zip(turns(values, TURN_DEG)).map(|(value, turns)| value + turns);
    continuous.map(|value| Some([value]).filter(|[value]| value.is_finite())).collect()
}

fn alignment_warnings(alignment: &Alignment) -> Vec<String> {
    let mut found = vec![];
    if let Some(RivalOffset { offset_s, ratio }) = alignment.rival {
        found.push(format!(
            "an offset of {offset_s:.2} s fits nearly as well as {:.2} s (misfit × {ratio:.2}): the motion repeats itself",
            alignment.offset_s
        ));
    }
    if alignment.is_short() && (alignment.parts.time || alignment.parts.space) {
        found.push(format!(
            "both overlap for {:.1} s: standard deviations of the alignment are from pieces of {:.2} s, which hang \
             together more than pieces of a second, and are rather too small",
            alignment.overlap_s, alignment.piece_s
        ));
    }
    found
}

/// Names and texts of the files; the picture has a title.
///
/// # Errors
/// None but of memory.
pub fn comparison_files(found: &Comparison, title: &str) -> Result<[(&'static str, String); 3], Error> {
    let [table, json, picture] = COMPARISON_NAMES;
    let values = format!("{:#}\n", as_json(found));
    Ok([(table, comparison_table(found)?), (json, values), (picture, bland_altman(title, found))])
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::trc::{self, Trc, TrcFrame};
    use std::fmt::Write as _;
    use std::fs;

    const FRAMES: usize = 240;
    const NAMES: [&str; 4] = ["Hip", "Knee", "Heel", "Wrist"];

    /// Where a point is, metres.
    fn place(point: usize, time_s: f64) -> [f64; 3] {
        let k = point as f64;
        let swing = |axis: f64| 0.2 * (4.3 * time_s + 1.3 * k + 2.1 * axis).sin();
        [0.4 * k + swing(0.0), 0.7 * (0.8 * time_s + k).cos() + swing(1.0), 0.5 + 0.3 * k * k + swing(2.0)]
    }

    /// A result folder, and a reference that is 0.2 s late and lacks a third of its places, given as `gap` says.
    fn held_against(gap: Option<[f64; 3]>) -> Comparison {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let axes = ["mean_m", "sd_m", "sd_within_m"].map(|what| ["x", "y", "z"].map(|axis| format!("{axis}_{what}")));
        let mut joints = format!("frame,joint,{}\n", axes.concat().join(","));
        let mut frames = "frame,time_s\n".to_owned();
        for frame in 0..FRAMES {
            let time = frame as f64 / 60.0;
            writeln!(frames, "{frame},{time}").unwrap();
            for (point, name) in NAMES.iter().enumerate() {
                let [x, y, z] = place(point, time);
                writeln!(joints, "{frame},{name},{x},{y},{z},0.01,0.01,0.01,0.01,0.01,0.01").unwrap();
            }
        }
        fs::write(path("summary.json"), "{}").unwrap();
        fs::write(path("frames.csv"), frames).unwrap();
        fs::write(path("joints.csv"), joints).unwrap();
        let header = trc::Header::new("lab.trc", 100.0, NAMES.map(str::to_owned).into());
        let row = |number: i64| {
            let time_s = number as f64 / 100.0;
            let seen = |point: usize| {
                let is_gap = (number / 20 + point as i64) % 3 == 0;
                if is_gap { gap } else { Some(trc::trc_from_world(place(point, time_s - 0.2))) }
            };
            TrcFrame { number, time_s, points: (0..NAMES.len()).map(seen).collect() }
        };
        let mut bytes = vec![];
        trc::write(&mut bytes, &Trc { header, frames: (1..450).map(row).collect(), warnings: vec![] }).unwrap();
        fs::write(path("lab.trc"), bytes).unwrap();
        let parts = PartsToAlign { time: true, space: true, scale: false };
        compare(folder.path(), &ComparisonRequest { reference: path("lab.trc"), names: None, parts }).unwrap()
    }

    #[test]
    fn gaps_that_a_laboratory_writes_as_zeros_are_gaps() {
        let (zeros, empty) = (held_against(Some([0.0; 3])), held_against(None));
        for found in [&zeros, &empty] {
            assert!((found.alignment.offset_s - 0.2).abs() < 1e-3, "{:?}", found.alignment);
            assert!(found.mean_distance_m.unwrap() < 1e-3, "{:?}", found.mean_distance_m);
        }
        let counts = |found: &Comparison| found.agreements.iter().map(|one| one.count).collect::<Vec<_>>();
        assert_eq!(counts(&zeros), counts(&empty));
        assert!(zeros.warnings.iter().any(|words| words.contains("0 0 0")), "{:?}", zeros.warnings);
        assert!(!empty.warnings.iter().any(|words| words.contains("0 0 0")), "{:?}", empty.warnings);
    }

    /// Our own table may jump, too: its angles are made continuous before they are averaged.
    #[test]
    fn own_angles_that_are_given_within_half_a_turn_are_continuous() {
        let folder = tempfile::tempdir().unwrap();
        let (mut angles, mut frames) =
            ("frame,name,mean_deg,q05_deg,q95_deg\n".to_owned(), "frame,time_s\n".to_owned());
        for frame in 0..60 {
            let turned = 170.0 + 20.0 * f64::from(frame % 2);
            let mean = if turned > 180.0 { turned - 360.0 } else { turned };
            writeln!(frames, "{frame},{}", f64::from(frame) / 60.0).unwrap();
            writeln!(angles, "{frame},pelvis_rotation,{mean},{},{}", mean - 1.0, mean + 1.0).unwrap();
        }
        fs::write(folder.path().join("frames.csv"), frames).unwrap();
        fs::write(folder.path().join("angles.csv"), angles).unwrap();
        let found = estimates::angles(folder.path()).unwrap();
        for (frame, own) in found.series[0].iter().enumerate() {
            let expected = 170.0 + 20.0 * (frame % 2) as f64;
            assert!((own.mean[0] - expected).abs() < 1e-9 && (own.sd[0] - 1.0 / 1.645).abs() < 1e-3, "{own:?}");
        }
    }
}
